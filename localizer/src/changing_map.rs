use interfaces::{CellState, Grid};
use mapper::Mapper;

/// What the localizer asks of the map that has learned changes. The map contains readings with a certain pose only: a
/// change that it knows was not made by an error of the pose.
pub trait ChangingMap {
    /// The states of the cells.
    fn states(&self) -> &Grid<CellState>;

    /// The rate of change of a cell, in cycles per second; 0 for a cell that never changed. Cells are addressed by
    /// their index in row-major order.
    fn rate(&self, index: usize) -> f64;
}

impl ChangingMap for Mapper {
    fn states(&self) -> &Grid<CellState> {
        Mapper::states(self)
    }

    fn rate(&self, index: usize) -> f64 {
        self.acting_rate(index)
    }
}

/// A map that never learns changes: a plain occupancy grid.
impl ChangingMap for Grid<CellState> {
    fn states(&self) -> &Grid<CellState> {
        self
    }

    fn rate(&self, _index: usize) -> f64 {
        0.0
    }
}

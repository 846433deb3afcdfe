//! A map in a larger frame.

use interfaces::{Cell, Grid, GridFrame, SparseCells};
use nalgebra::Vector2;

/// How the cells of a map move when its frame grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    from: GridFrame,
    to: GridFrame,
    /// The first column and row of the smaller frame in the larger one.
    column: usize,
    row: usize,
}

impl Growth {
    /// From one frame to another one, which covers it with the same cells; `None` if it does not.
    pub fn new(from: GridFrame, to: GridFrame) -> Option<Self> {
        let cells = (from.origin() - to.origin()) / to.resolution_m();
        let whole = cells.map(f64::round);
        let is_same_grid = from.resolution_m() == to.resolution_m() && (cells - whole).norm() < 1e-6;
        let is_inside = whole.min() >= 0.0
            && whole.x + from.width() as f64 <= to.width() as f64
            && whole.y + from.height() as f64 <= to.height() as f64;
        let (column, row) = (whole.x as usize, whole.y as usize);
        (is_same_grid && is_inside).then_some(Self { from, to, column, row })
    }

    /// The larger frame.
    pub fn frame(&self) -> &GridFrame {
        &self.to
    }

    /// How far the lower left corner of the smaller frame is from that of the larger one, m.
    pub fn shift_m(&self) -> Vector2<f64> {
        Vector2::new(self.column as f64, self.row as f64) * self.to.resolution_m()
    }

    /// The index in the larger frame of a cell of the smaller one.
    pub fn index(&self, index: usize) -> usize {
        let Cell { x, y } = self.from.cell(index);
        (y as usize + self.row) * self.to.width() + x as usize + self.column
    }

    /// Moves the cells of a grid; the new cells have the value of those that never got another one.
    pub(crate) fn grid<T: Clone + PartialEq>(&self, grid: &mut Grid<T>) {
        let mut moved = Grid::filled(self.to, grid.cells().fill().clone());
        self.move_to(moved.cells_mut(), grid.cells());
        *grid = moved;
    }

    /// The same for cells without a frame.
    pub(crate) fn sparse<T: Clone + PartialEq>(&self, cells: &mut SparseCells<T>) {
        let (width, height) = (self.to.width(), self.to.height());
        let new = if cells.is_small() { SparseCells::new } else { SparseCells::in_blocks };
        let mut moved = new(width, height, cells.fill().clone());
        self.move_to(&mut moved, cells);
        *cells = moved;
    }

    fn move_to<T: Clone + PartialEq>(&self, moved: &mut SparseCells<T>, cells: &SparseCells<T>) {
        cells.stored().for_each(|(index, value)| moved.set(self.index(index), value.clone()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    fn frame(x: f64, y: f64, width: usize, height: usize) -> GridFrame {
        GridFrame::new(Point2::new(x, y), 0.1, width, height).unwrap()
    }

    #[test]
    fn values_stay_at_their_places() {
        let (small, large) = (frame(0.3, -0.2, 2, 3), frame(0.1, -0.5, 5, 7));
        let growth = Growth::new(small, large).unwrap();
        let mut sparse = SparseCells::from_vec(2, vec![0, 2, 3, 4, 5, 6]);
        growth.sparse(&mut sparse);
        for index in 0..small.len() {
            assert_eq!(sparse[growth.index(index)], if index == 0 { 0 } else { index + 1 });
            let off = large.center(large.cell(growth.index(index))) - small.center(small.cell(index));
            assert!(off.norm() < 1e-9, "{off}");
        }
        assert!((growth.shift_m() - Vector2::new(0.2, 0.3)).norm() < 1e-9);
    }

    #[test]
    fn a_frame_that_does_not_cover_the_other_is_no_growth() {
        let small = frame(0.3, -0.2, 2, 3);
        assert!(Growth::new(small, small).is_some());
        for other in [frame(0.4, -0.2, 9, 9), frame(0.3, -0.2, 1, 9), frame(0.25, -0.2, 9, 9)] {
            assert_eq!(Growth::new(small, other), None, "{other:?}");
        }
        let coarse = GridFrame::new(Point2::new(0.0, -1.0), 0.2, 9, 9).unwrap();
        assert_eq!(Growth::new(small, coarse), None);
    }
}

//! Maps as messages: as a whole, or the part that changed.

use super::messages::{Header, OccupancyGrid, OccupancyGridUpdate, Pose};
use interfaces::{Cell, Grid};
use nalgebra::Isometry2;

impl OccupancyGrid {
    /// The message of a map of percents, −1 where unknown.
    pub fn of(grid: &Grid<i8>, header: Header) -> Self {
        let frame = grid.frame();
        let origin = Isometry2::translation(frame.origin().x, frame.origin().y);
        Self {
            map_load_time: header.stamp,
            header,
            resolution: frame.resolution_m() as f32,
            width: frame.width() as u32,
            height: frame.height() as u32,
            origin: Pose::in_plane(&origin),
            data: grid.cells().to_vec(),
        }
    }
}

impl OccupancyGridUpdate {
    /// The smallest rectangle of a map that contains these cells; `None` if there is none.
    pub fn around(grid: &Grid<i8>, cells: impl Iterator<Item = Cell>, header: Header) -> Option<Self> {
        let (low, high) = cells.map(|cell| (cell, cell)).reduce(|(low, high), (cell, _)| {
            let low = Cell::new(low.x.min(cell.x), low.y.min(cell.y));
            (low, Cell::new(high.x.max(cell.x), high.y.max(cell.y)))
        })?;
        let cells = (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| Cell::new(x, y)));
        Some(Self {
            header,
            x: low.x,
            y: low.y,
            width: (high.x - low.x + 1) as u32,
            height: (high.y - low.y + 1) as u32,
            data: cells.filter_map(|cell| grid.get(cell).copied()).collect(),
        })
    }
}

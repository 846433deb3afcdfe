//! Maps: as a whole, or the part that changed.

use super::channels::Channels;
use crate::error::LogError;
use crate::ros::{Header, OccupancyGrid, OccupancyGridUpdate, Pose};
use interfaces::{Cell, Grid};
use nalgebra::Isometry2;
use std::collections::BTreeMap;
use std::io::{Seek, Write};

/// A map that changes is written as a whole when the last whole one is older than this, ns: a viewer that shows no updates,
/// or jumps in time, is at most this late.
const WHOLE_PERIOD_NS: i64 = 5_000_000_000;

/// What was written last, by topic.
#[derive(Default)]
pub(super) struct Grids {
    last: BTreeMap<String, (i64, Grid<i8>)>,
}

impl Grids {
    /// Writes a map of percents, −1 where unknown.
    pub(super) fn write<W: Write + Seek>(
        &mut self,
        channels: &mut Channels<W>,
        topic: &str,
        header: Header,
        ns: i64,
        grid: &Grid<i8>,
    ) -> Result<(), LogError> {
        let known = self.last.get_mut(topic).filter(|(_, last)| last.frame() == grid.frame());
        if let Some((whole_ns, last)) = known {
            let Some((low, high)) = difference(last, grid) else { return Ok(()) };
            if ns - *whole_ns < WHOLE_PERIOD_NS {
                *last = grid.clone();
                let update = part(grid, low, high, header);
                let topic = format!("{topic}_updates");
                return channels.write(&topic, "map_msgs/OccupancyGridUpdate", ns, &update);
            }
        }
        self.last.insert(topic.to_owned(), (ns, grid.clone()));
        channels.write(topic, "nav_msgs/OccupancyGrid", ns, &whole(grid, header))
    }
}

/// The corners of the rectangle in which two maps differ, both inclusive.
fn difference(before: &Grid<i8>, after: &Grid<i8>) -> Option<(Cell, Cell)> {
    let pairs = before.cells().iter().zip(after.cells()).enumerate();
    let changed = pairs.filter(|(_, (before, after))| before != after).map(|(index, _)| index);
    changed.map(|index| after.frame().cell(index)).map(|cell| (cell, cell)).reduce(
        |(low, high), (cell, _)| {
            let low = Cell::new(low.x.min(cell.x), low.y.min(cell.y));
            (low, Cell::new(high.x.max(cell.x), high.y.max(cell.y)))
        },
    )
}

fn part(grid: &Grid<i8>, low: Cell, high: Cell, header: Header) -> OccupancyGridUpdate {
    let cells = (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| Cell::new(x, y)));
    OccupancyGridUpdate {
        header,
        x: low.x,
        y: low.y,
        width: (high.x - low.x + 1) as u32,
        height: (high.y - low.y + 1) as u32,
        data: cells.filter_map(|cell| grid.get(cell).copied()).collect(),
    }
}

fn whole(grid: &Grid<i8>, header: Header) -> OccupancyGrid {
    let frame = grid.frame();
    let origin = Isometry2::translation(frame.origin().x, frame.origin().y);
    OccupancyGrid {
        map_load_time: header.stamp,
        header,
        resolution: frame.resolution_m() as f32,
        width: frame.width() as u32,
        height: frame.height() as u32,
        origin: Pose::in_plane(&origin),
        data: grid.cells().to_vec(),
    }
}

//! Maps: as a whole, or the part that changed.

use super::channels::Channels;
use crate::messages::{Header, OccupancyGrid, OccupancyGridUpdate};
use interfaces::Grid;
use std::collections::BTreeMap;
use std::io::{Error, Write};

/// A map that changes is written as a whole when the last whole one is older than this, ns: a viewer that shows no updates,
/// or jumps in time, is at most this late.
const WHOLE_PERIOD_NS: i64 = 5_000_000_000;
/// A map of n times as many cells has a period n times as long.
const MANY_CELLS: usize = 1 << 20;

/// What was written last, by topic.
#[derive(Default)]
pub(super) struct Grids {
    last: BTreeMap<String, (i64, Grid<i8>)>,
}

impl Grids {
    /// Writes a map of percents, −1 where unknown.
    pub(super) fn write<W: Write>(
        &mut self,
        channels: &mut Channels<W>,
        topic: &str,
        header: Header,
        ns: i64,
        grid: &Grid<i8>,
    ) -> Result<(), Error> {
        let known = self.last.get_mut(topic).filter(|(_, last)| last.frame() == grid.frame());
        if let Some((whole_ns, last)) = known {
            let update = OccupancyGridUpdate::between(last, grid, header.clone());
            let Some(update) = update else { return Ok(()) };
            let periods = grid.frame().len().div_ceil(MANY_CELLS) as i64;
            if ns - *whole_ns < periods * WHOLE_PERIOD_NS {
                *last = grid.clone();
                let topic = format!("{topic}_updates");
                return channels.write(&topic, "map_msgs/OccupancyGridUpdate", ns, &update);
            }
        }
        self.last.insert(topic.to_owned(), (ns, grid.clone()));
        channels.write(topic, "nav_msgs/OccupancyGrid", ns, &OccupancyGrid::of(grid, header))
    }
}

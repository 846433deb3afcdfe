//! Cells that changed hang together in things, and what lies beside them is likelier to change too.

use interfaces::{Cell, GridFrame};
use mapper::Mapper;

/// The pseudocounts of a thing's pace: half a cycle in fifty units of time.
const PRIOR_CYCLES: f64 = 0.5;
const PRIOR_TIME: f64 = 50.0;

/// No thing.
const NONE: u32 = u32::MAX;

/// Where a cell lies to what changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Position {
    /// No cell beside it ever changed.
    Far,
    /// One did that lies amid others which did: a way that goes on past this cell.
    Middle,
    /// One did that has at most one other beside it: the end of the way, as far as it is known.
    End,
}

/// The cells that ever changed, joined where they share a side.
#[derive(Clone, Debug, Default)]
pub(super) struct Things {
    /// Per cell the thing it belongs to.
    of: Vec<u32>,
    /// Per changed cell, the changed cells beside it.
    degrees: Vec<u8>,
    /// Per thing the mean cycles of its cells per unit of time in view.
    paces: Vec<f64>,
}

/// The cells that share a side with one, by their numbers.
pub(super) fn beside(frame: &GridFrame, cell: usize) -> impl Iterator<Item = usize> {
    let frame = *frame;
    Cell::neighbours4(frame.cell(cell)).into_iter().filter_map(move |cell| frame.index(cell))
}

impl Things {
    /// Joins what ever changed. A pass over the changed cells, with a vector as large as the map.
    pub(super) fn new(mapper: &Mapper) -> Self {
        let frame = mapper.frame();
        let mut things =
            Self { of: vec![NONE; frame.len()], degrees: vec![0; frame.len()], paces: Vec::new() };
        let is_changed = {
            let mut is_changed = vec![false; frame.len()];
            mapper.changed().for_each(|cell| is_changed[cell] = true);
            is_changed
        };
        let mut open = Vec::new();
        for start in mapper.changed() {
            if things.of[start] != NONE {
                continue;
            }
            let thing = things.paces.len() as u32;
            things.of[start] = thing;
            open.push(start);
            let (mut cycles, mut time) = (PRIOR_CYCLES, PRIOR_TIME);
            while let Some(cell) = open.pop() {
                let seen = mapper.statistics(cell);
                cycles += 0.5 * f64::from(seen.block_events + seen.free_events);
                time += seen.watched_free + seen.watched_blocked;
                for near in beside(frame, cell).filter(|&near| is_changed[near]) {
                    things.degrees[cell] += 1;
                    if things.of[near] == NONE {
                        things.of[near] = thing;
                        open.push(near);
                    }
                }
            }
            things.paces.push(cycles / time);
        }
        things
    }

    /// Whether the cell ever changed.
    #[inline]
    pub(super) fn has(&self, cell: usize) -> bool {
        self.of[cell] != NONE
    }

    /// How many of the cells beside one that changed did so too.
    #[inline]
    pub(super) fn degree(&self, cell: usize) -> u8 {
        self.degrees[cell]
    }

    /// The pace of the thing that a changed cell belongs to; `None` for other cells.
    pub(super) fn pace(&self, cell: usize) -> Option<f64> {
        self.paces.get(self.of[cell] as usize).copied()
    }

    /// Where a cell lies to the things, itself left out, and the pace of the slowest beside it (∞ far
    /// from all).
    pub(super) fn position(&self, frame: &GridFrame, cell: usize) -> (Position, f64) {
        let (mut position, mut pace) = (Position::Far, f64::INFINITY);
        for near in beside(frame, cell).filter(|&near| self.has(near)) {
            let others = self.degrees[near] - u8::from(self.has(cell));
            position = position.max(if others <= 1 { Position::End } else { Position::Middle });
            pace = pace.min(self.paces[self.of[near] as usize]);
        }
        (position, pace)
    }
}

//! Things: cells that change together. Doors, and objects that come and go as a whole.
//!
//! - `lasting`: changes that last, out of all changes of cells.
//! - `motions`: changes near each other, at about the same time.
//! - `segment`, `line`: the straight lines in a motion. A leaf at rest is one.
//! - `doorway`, `doors`: lines that come and go between two walls are the closed leaf of a door; a line that changes the other
//!   way at the same time, and shares an end with it, is the open leaf.
//! - `door`: a door, and what looks at it say.
//! - `object`, `objects`: what comes and goes as a whole.
//! - `presence`: what looks say of a door or an object: its state, the evidence about its stays, and its cells in both states.
//! - `of_cell`: what a door or an object says of one of its cells.

mod door;
mod doors;
mod doorway;
mod lasting;
mod line;
mod motions;
mod object;
mod objects;
mod of_cell;
mod presence;
mod segment;

use crate::Growth;
use crate::change::CellMap;
use crate::clock::Dates;
pub use door::{Door, Leaf};
use doorway::Doorway;
use lasting::{Change, LastingChanges};
use line::Line;
use motions::{Motion, Motions};
pub use objects::ObjectReport;
use objects::Objects;
pub(crate) use of_cell::OfCell;
pub use segment::Segment;

/// Finds things, and counts what they do.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Things {
    changes: LastingChanges,
    motions: Motions,
    /// The last lines that were found.
    lines: Vec<Line>,
    /// Places where a door can be.
    doorways: Vec<Doorway>,
    doors: Vec<Door>,
    pub(crate) objects: Objects,
    next_door: u32,
}

impl Things {
    /// All doors, in the order in which they were found.
    pub(crate) fn doors(&self) -> &[Door] {
        &self.doors
    }

    /// What the thing to which a cell belongs says of it.
    pub(crate) fn of_cell(&self, cell: usize) -> Option<OfCell<'_>> {
        self.of_door(cell).or_else(|| self.objects.of_cell(cell as u32))
    }

    /// What the door to which a cell belongs says of it.
    pub(crate) fn of_door(&self, cell: usize) -> Option<OfCell<'_>> {
        self.doors.iter().find_map(|door| door.of_cell(cell as u32))
    }

    /// The number of things.
    pub(crate) fn count(&self) -> usize {
        self.doors.len() + self.objects.count()
    }

    /// Learns from the open reading. `is_doubted`: whether it speaks against the state of a cell in the map.
    pub(crate) fn update(&mut self, cells: &CellMap, is_doubted: impl Fn(usize) -> bool, dates: Dates) {
        let (frame, now_s) = (cells.frame(), cells.time());
        self.changes.add(cells);
        while let Some(change) = self.changes.next(cells) {
            self.motions.add(change, frame.center(frame.cell(change.cell as usize)), now_s);
        }
        while let Some(motion) = self.motions.next(now_s) {
            self.learn(&motion, cells);
        }
        // A cell that has just changed says nothing: the inside of a body becomes blocked without being seen.
        let new: std::collections::BTreeSet<usize> =
            cells.transitions.iter().filter_map(|transition| frame.index(transition.cell)).collect();
        self.objects.observe(cells, |index| is_doubted(index) || new.contains(&index));
        self.doors.iter_mut().for_each(|door| door.observe(cells, &is_doubted, dates));
    }

    /// Learns from a motion that is over.
    fn learn(&mut self, motion: &Motion, cells: &CellMap) {
        for is_blocked in [false, true] {
            let changes: Vec<Change> =
                motion.changes.iter().filter(|change| change.is_blocked == is_blocked).copied().collect();
            let is_door = Line::of(&changes, motion.begin_s(), cells.frame())
                .is_some_and(|line| self.add_line(line, cells));
            if !is_door && !self.is_at_door(&changes) {
                self.objects.learn(&changes, cells);
            }
        }
    }

    /// Whether most of the changes are cells of a door.
    fn is_at_door(&self, changes: &[Change]) -> bool {
        let cells: Vec<u32> = changes.iter().map(|change| change.cell).collect();
        self.doors.iter().any(|door| is_mostly_in(&cells, &door.cells))
    }

    /// Moves all cells into a larger map.
    pub(crate) fn grow(&mut self, growth: &Growth) {
        self.each_cell(&mut |cell| *cell = growth.index(*cell as usize) as u32);
    }

    /// Whether all values can be those of a map: a state can hold anything.
    pub(crate) fn is_sound(&mut self, map: &CellMap) -> bool {
        let (mut is_in_map, cells) = (true, map.frame().len());
        self.each_cell(&mut |cell| is_in_map &= (*cell as usize) < cells);
        is_in_map && self.changes.is_sound(map)
    }

    fn each_cell(&mut self, f: &mut dyn FnMut(&mut u32)) {
        self.motions.each_cell(f);
        self.lines.iter_mut().for_each(|line| line.each_cell(f));
        self.doorways.iter_mut().for_each(|doorway| doorway.each_cell(f));
        self.objects.each_cell(f);
        self.doors.iter_mut().for_each(|door| door.each_cell(f));
    }
}

/// Whether more than half of the cells are among others, which are sorted.
fn is_mostly_in(cells: &[u32], others: &[u32]) -> bool {
    2 * cells.iter().filter(|cell| others.binary_search(cell).is_ok()).count() > cells.len()
}

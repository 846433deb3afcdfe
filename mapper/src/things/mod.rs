//! Things: cells that change together, such as those of a door or of a piece of furniture.
//!
//! - `lasting`: changes that last, out of all changes of cells.
//! - `motions`: changes near each other, at about the same time.
//! - `segment`, `line`: the straight lines in a motion. A leaf at rest is one.
//! - `doorway`, `doors`: lines that come and go between two walls are the closed leaf of a door; a line that changes the other
//!   way at the same time, and shares an end with it, is the open leaf.
//! - `door`: a door and its statistics.
//! - `object`, `objects`: what comes and goes as a whole.
//! - `presence`: what looks say of a door or an object: its state, the evidence about its stays, and its cells in both states.
//! - `of_cell`: what a door or an object says of one of its cells.
//! - `furniture`: what stood for long and is gone, or has come and stays.

mod door;
mod doors;
mod doorway;
mod furniture;
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
pub use furniture::{Furniture, Place};
use lasting::{Change, LastingChanges};
use line::Line;
use motions::{Motion, Motions};
use objects::Objects;
pub(crate) use of_cell::OfCell;
pub use segment::Segment;

/// The largest number of pieces of furniture; then the one that was found first is forgotten. Doors are bounded by the doorways.
const MAX_FURNITURE: usize = 64;

/// Cells that change together.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Thing {
    /// Its number, which it keeps over all sessions.
    pub id: u32,
    /// What it is.
    pub kind: ThingKind,
    /// The cells that it covers, now or at other times, by their index.
    pub cells: Vec<u32>,
    /// The time at which it was found, s.
    pub found_s: f64,
}

/// What a thing is.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub enum ThingKind {
    /// A door.
    Door(Box<Door>),
    /// A piece of furniture that stands elsewhere since.
    Furniture(Furniture),
}

/// Finds things, and counts what they do.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Things {
    changes: LastingChanges,
    motions: Motions,
    /// The last lines that were found.
    lines: Vec<Line>,
    /// Places where a door can be.
    doorways: Vec<Doorway>,
    places: furniture::Pending,
    things: Vec<Thing>,
    objects: Objects,
    next_id: u32,
}

impl Things {
    /// All things, in the order in which they were found.
    pub(crate) fn all(&self) -> &[Thing] {
        &self.things
    }

    /// What the thing to which a cell belongs says of it.
    pub(crate) fn of_cell(&self, cell: usize) -> Option<OfCell<'_>> {
        let cell = cell as u32;
        let doors = self.things.iter().filter_map(|thing| match &thing.kind {
            ThingKind::Door(door) => Some(door),
            ThingKind::Furniture(_) => None,
        });
        doors.filter_map(|door| door.of_cell(cell)).next().or_else(|| self.objects.of_cell(cell))
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
        self.objects.observe(cells, is_doubted);
        if cells.reading().is_multiple_of(furniture::READINGS) {
            self.check_furniture(cells);
        }
        for thing in &mut self.things {
            if let ThingKind::Door(door) = &mut thing.kind {
                door.observe(cells, dates);
            }
        }
    }

    /// Learns from a motion that is over.
    fn learn(&mut self, motion: &Motion, cells: &CellMap) {
        for is_blocked in [false, true] {
            let changes: Vec<Change> =
                motion.changes.iter().filter(|change| change.is_blocked == is_blocked).copied().collect();
            let is_door = Line::of(&changes, motion.begin_s(), cells.frame())
                .is_some_and(|line| self.add_line(line, cells));
            if !is_door && !self.is_at_door(&changes) {
                self.places.add(&changes, cells);
                self.objects.learn(&changes, cells);
            }
        }
    }

    /// Whether most of the changes are cells of a door.
    fn is_at_door(&self, changes: &[Change]) -> bool {
        let mut doors = self.things.iter().filter(|thing| matches!(thing.kind, ThingKind::Door(_)));
        let cells: Vec<u32> = changes.iter().map(|change| change.cell).collect();
        doors.any(|door| is_mostly_in(&cells, &door.cells))
    }

    fn check_furniture(&mut self, cells: &CellMap) {
        if let Some((place, is_blocked)) = self.places.next(cells) {
            self.add_furniture(place, is_blocked, cells);
        }
        self.things.retain(|thing| match &thing.kind {
            ThingKind::Door(_) => true,
            ThingKind::Furniture(furniture) => !furniture.was_passing(cells),
        });
    }

    fn add_furniture(&mut self, place: Place, is_blocked: bool, cells: &CellMap) {
        for thing in &mut self.things {
            if let ThingKind::Furniture(furniture) = &mut thing.kind
                && furniture.take(&place, is_blocked)
            {
                thing.cells = furniture.places().flat_map(|place| place.cells.iter().copied()).collect();
                return;
            }
        }
        let is_furniture = |thing: &Thing| matches!(thing.kind, ThingKind::Furniture(_));
        if self.things.iter().filter(|thing| is_furniture(thing)).count() >= MAX_FURNITURE
            && let Some(oldest) = self.things.iter().position(is_furniture)
        {
            self.things.remove(oldest);
        }
        let covered = place.cells.clone();
        let (from, to) = if is_blocked { (None, Some(place)) } else { (Some(place), None) };
        self.add(ThingKind::Furniture(Furniture { from, to }), covered, cells.time());
    }

    /// Adds a thing; returns its number.
    fn add(&mut self, kind: ThingKind, cells: Vec<u32>, found_s: f64) -> u32 {
        let id = self.next_id;
        self.next_id += 1;
        self.things.push(Thing { id, kind, cells, found_s });
        id
    }

    /// Moves all cells into a larger map.
    pub(crate) fn grow(&mut self, growth: &Growth) {
        self.motions.grow(growth);
        self.lines.iter_mut().for_each(|line| line.grow(growth));
        self.doorways.iter_mut().for_each(|doorway| doorway.grow(growth));
        self.places.grow(growth);
        self.objects.grow(growth);
        for thing in &mut self.things {
            thing.cells.iter_mut().for_each(|cell| *cell = growth.index(*cell as usize) as u32);
            match &mut thing.kind {
                ThingKind::Door(door) => door.grow(growth),
                ThingKind::Furniture(furniture) => furniture.grow(growth),
            }
        }
    }
}

/// Whether more than half of the cells are among others, which are sorted.
fn is_mostly_in(cells: &[u32], others: &[u32]) -> bool {
    2 * cells.iter().filter(|cell| others.binary_search(cell).is_ok()).count() > cells.len()
}

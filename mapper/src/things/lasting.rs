//! Changes that last: a person who walks past changes cells for a moment only.

use crate::change::{CellMap, ReadingIndex};
use interfaces::CellState;
use std::collections::{BTreeMap, VecDeque};

/// A change lasts when the cell has kept its state for this time, s.
const LASTING_S: f64 = 1.5;

/// A change of a cell that lasted.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Change {
    pub(super) cell: u32,
    /// Whether the cell is blocked now; otherwise it is free.
    pub(super) is_blocked: bool,
    /// The time at which the cell left its last lasting state, s.
    pub(super) time_s: f64,
}

/// A change that may last.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
struct Pending {
    /// The reading in which the cell left its last lasting state, and that of its last change.
    left: ReadingIndex,
    last: ReadingIndex,
    was_blocked: bool,
}

/// Finds the changes that last.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(super) struct LastingChanges {
    /// By the position in [`CellMap::changed`].
    pending: BTreeMap<u32, Pending>,
    recent: VecDeque<Recent>,
}

/// A recent change: its position in [`CellMap::changed`], reading and time.
type Recent = (u32, ReadingIndex, f64);

impl LastingChanges {
    /// Adds the changes of the open reading.
    pub(super) fn add(&mut self, cells: &CellMap) {
        let (reading, time_s) = (cells.reading(), cells.time());
        for transition in &cells.transitions {
            let Some(slot) = cells.frame().index(transition.cell).and_then(|index| cells.slot(index)) else {
                continue;
            };
            let was_blocked = transition.before == CellState::Blocked;
            let pending = Pending { left: reading, last: reading, was_blocked };
            self.pending.entry(slot).or_insert(pending).last = reading;
            self.recent.push_back((slot, reading, time_s));
        }
    }

    /// The next change that has lasted.
    pub(super) fn next(&mut self, cells: &CellMap) -> Option<Change> {
        let is_over = |(_, _, time_s): &mut Recent| *time_s <= cells.time() - LASTING_S;
        while let Some((slot, reading, _)) = self.recent.pop_front_if(is_over) {
            if self.pending.get(&slot).is_none_or(|pending| pending.last != reading) {
                continue;
            }
            let Some(Pending { left, was_blocked, .. }) = self.pending.remove(&slot) else { continue };
            let cell = cells.changed[slot as usize];
            let is_blocked = cells.state(cell as usize) == CellState::Blocked;
            if is_blocked != was_blocked {
                return Some(Change { cell, is_blocked, time_s: cells.time_of(left) });
            }
        }
        None
    }

    /// Whether all changes are of cells of the map, and of readings that it knows.
    pub(super) fn is_sound(&self, map: &CellMap) -> bool {
        let slots = self.pending.keys().chain(self.recent.iter().map(|(slot, ..)| slot));
        let mut slots = slots.map(|slot| *slot as usize);
        slots.all(|slot| slot < map.changed.len())
            && self.pending.values().all(|pending| pending.left <= map.reading())
    }
}

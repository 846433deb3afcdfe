//! The cells in a state file, and in a larger map.

use super::record::{Flags, Record};
use super::{CellMap, NEVER, observing};
use crate::Growth;
use interfaces::{CellState, Values, runs, value};

impl CellMap {
    /// The changing values, and apart from them those of the prior that cells share: absent from the snapshot of a mapper whose
    /// cells share none. Values that follow from others are not in the lists.
    pub(crate) fn values(&mut self) -> (Values<'_>, Values<'_>) {
        let mut values = vec![
            value(&mut self.interrupted),
            runs(self.states.cells_mut()),
            value(&mut self.times),
            runs(&mut self.observed),
            runs(&mut self.records),
            value(&mut self.regularity),
            value(&mut self.changed),
            value(&mut self.returned),
            value(&mut self.transitions),
            value(&mut self.last_seen_counts),
        ];
        values.extend(self.gaps.values());
        let prior = self
            .shared
            .as_mut()
            .map(|shared| vec![value(&mut shared.prior), value(&mut shared.due), runs(&mut shared.means)]);
        (values, prior.unwrap_or_default())
    }

    /// Computes what follows from the values.
    pub(crate) fn derive(&mut self) {
        for index in 0..self.flags.len() {
            let has_changed = self.records[index].slot().is_some();
            self.flags[index] = Flags { is_candidate: self.is_free_or_beside(index), has_changed };
        }
    }

    /// Moves all cells into a larger map.
    pub(crate) fn grow(&mut self, growth: &Growth) {
        growth.grid(&mut self.states, CellState::Unknown);
        growth.cells(&mut self.observed, NEVER | observing::UNSETTLED);
        growth.cells(&mut self.records, Record::default());
        growth.cells(&mut self.flags, Flags::default());
        self.gaps.grow(growth);
        if let Some(shared) = &mut self.shared {
            growth.cells(&mut shared.means, 0.0);
        }
        self.changed.iter_mut().for_each(|index| *index = growth.index(*index as usize) as u32);
        self.transitions.clear();
        // A new cell can be beside a free one.
        for index in 0..self.flags.len() {
            if self.last_reading(index) == NEVER {
                self.update_candidate(index);
            }
        }
    }

    /// Whether the cell is free, or shares a side with a free cell.
    pub(super) fn is_free_or_beside(&self, index: usize) -> bool {
        let is_free = |index: usize| self.state(index) == CellState::Free;
        is_free(index) || self.frame().beside(index).any(is_free)
    }
}

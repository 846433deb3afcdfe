//! The cells in a state file.

use super::CellMap;
use interfaces::{CellState, Values, runs, value};

impl CellMap {
    /// The changing values; those that follow from them are not in the list.
    pub(crate) fn values(&mut self) -> Values<'_> {
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
        values
    }

    /// Computes what follows from the values.
    pub(crate) fn derive(&mut self) {
        for index in 0..self.candidates.len() {
            self.candidates[index] = self.is_free_or_beside(index);
        }
    }

    /// Whether the cell is free, or shares a side with a free cell.
    pub(super) fn is_free_or_beside(&self, index: usize) -> bool {
        let is_free = |index: usize| self.state(index) == CellState::Free;
        is_free(index) || self.frame().beside(index).any(is_free)
    }
}

//! The cells in a state file, and in a larger map.

use super::record::Flags;
use super::{CellMap, NEVER};
use crate::Growth;
use crate::change::shared_cells;
use interfaces::{CellState, SparseCells, Values, cell_runs, value};

impl CellMap {
    /// The changing values. Values that follow from others are not in the list.
    pub(crate) fn values(&mut self) -> Values<'_> {
        let mut values = vec![
            value(&mut self.interrupted),
            cell_runs(self.states.cells_mut(), usize::MAX),
            value(&mut self.times),
            cell_runs(&mut self.observed, usize::MAX),
            cell_runs(&mut self.records, usize::MAX),
            value(&mut self.regularity),
            value(&mut self.changed),
            value(&mut self.returned),
            value(&mut self.transitions),
            value(&mut self.last_seen_counts),
        ];
        values.push(cell_runs(&mut self.gaps, shared_cells::RUN));
        if let Some(shared) = &mut self.shared {
            let means = cell_runs(&mut shared.means, usize::MAX);
            values.extend([value(&mut shared.prior), value(&mut shared.due), means]);
        }
        values
    }

    /// Computes what follows from the values.
    pub(crate) fn derive(&mut self) {
        let frame = *self.frame();
        self.flags = SparseCells::new(frame.width(), frame.height(), Flags::default());
        for index in self.free_cells() {
            self.flags[index].is_candidate = true;
            frame.beside(index).for_each(|index| self.flags[index].is_candidate = true);
        }
        for index in self.changed.iter().map(|index| *index as usize).filter(|index| *index < frame.len()) {
            self.flags[index].has_changed = true;
        }
        self.gap_bytes = self.gaps.changed().map(|gaps| gaps.histogram.owned_bytes()).sum();
    }

    /// Moves all cells into a larger map.
    pub(crate) fn grow(&mut self, growth: &Growth) {
        growth.grid(&mut self.states);
        growth.sparse(&mut self.observed);
        self.records.grow(growth);
        growth.sparse(&mut self.flags);
        self.gaps.grow(growth);
        if let Some(shared) = &mut self.shared {
            growth.sparse(&mut shared.means);
        }
        self.changed.iter_mut().for_each(|index| *index = growth.index(*index as usize) as u32);
        self.transitions.clear();
        // A new cell can be beside a free one.
        for index in self.free_cells() {
            for neighbor in self.frame().beside(index) {
                if self.last_reading(neighbor) == NEVER {
                    self.update_candidate(neighbor);
                }
            }
        }
    }

    fn free_cells(&self) -> Vec<usize> {
        let known = self.states.cells().other_than(CellState::Unknown);
        known.filter(|(_, state)| **state == CellState::Free).map(|(index, _)| index).collect()
    }

    /// Whether the cell is free, or shares a side with a free cell.
    pub(super) fn is_free_or_beside(&self, index: usize) -> bool {
        let is_free = |index: usize| self.state(index) == CellState::Free;
        is_free(index) || self.frame().beside(index).any(is_free)
    }
}

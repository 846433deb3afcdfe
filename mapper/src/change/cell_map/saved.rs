//! The cells in a state file, and in a larger map.

use super::observing::UNSETTLED;
use super::record::Flags;
use super::{CellMap, NEVER};
use crate::Growth;
use crate::change::shared_cells;
use interfaces::{CellState, SparseCells, ValueError, Values, cell_runs, value};

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
    ///
    /// # Errors
    ///
    /// When they do not fit each other: a state can hold anything.
    pub(crate) fn derive(&mut self) -> Result<(), ValueError> {
        let frame = *self.frame();
        if !self.times.is_sound() || self.changed.iter().any(|index| *index as usize >= frame.len()) {
            return Err(ValueError);
        }
        self.flags = SparseCells::new(frame.width(), frame.height(), Flags::default());
        for index in self.free_cells() {
            self.flags[index].is_candidate = true;
            frame.beside(index).for_each(|index| self.flags[index].is_candidate = true);
        }
        for index in &self.changed {
            self.flags[*index as usize].has_changed = true;
        }
        self.gap_bytes = self.gaps.changed().map(|gaps| gaps.histogram.owned_bytes()).sum();
        if self.is_sound() { Ok(()) } else { Err(ValueError) }
    }

    /// Whether all readings and cells to which values refer exist.
    fn is_sound(&self) -> bool {
        let open = self.reading();
        let seen = self.observed.stored_values().map(|last| last & !UNSETTLED);
        let mut readings = seen.chain(self.records.readings()).chain([self.interrupted]);
        let candidates = self.flags.stored().filter(|(_, flags)| flags.is_candidate);
        let candidates = candidates.map(|(index, _)| self.last_reading(index));
        readings.all(|reading| reading <= open)
            && self.returned.iter().all(|slot| (*slot as usize) < self.changed.len())
            && self.records.are_sound(&self.changed, open)
            && self.last_seen_counts.is_sound(candidates, open)
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

//! Cells that change their state.

use super::record::{Record, state_index};
use super::{CellMap, PRIOR, ReadingIndex, Slot};
use crate::change::gaps::{CellGaps, neighbors};
use interfaces::{Cell, CellState, Transition};

/// The neighborhood of a cell extends this many cells in each direction along both axes.
const NEAR: i32 = 3;

impl CellMap {
    /// Changes the state of the cell. `since` is the reading that first observed the new state: the open reading,
    /// or an earlier one if several readings were needed as evidence. `in_view` states whether the cell was [in
    /// view](Self::is_in_view) at that reading: if so, the change happened in view; otherwise the change was found
    /// after a gap.
    pub fn set_state(&mut self, index: usize, after: CellState, since: ReadingIndex, in_view: bool) {
        let before = self.state(index);
        let is_event = before != CellState::Unknown && self.records.is_known(index);
        if !self.is_seen_now(index) && !self.is_in_view(index) {
            self.end_gap(index, after);
            self.mark(index);
        } else if is_event && let Some(gaps) = self.gaps.changed_mut(index) {
            gaps.histogram.correct_last(since, after == CellState::Blocked);
        }
        if is_event {
            self.record_event(index, before, since, in_view);
        }
        let cell = self.frame().cell(index);
        self.transitions.push(Transition { cell, before, after });
        self.states.cells_mut()[index] = after;
        if after == CellState::Blocked {
            self.set_settled(index, false);
        }
        self.observe(index);
        self.weigh_gaps(index);
        self.update_candidates_around(index);
    }

    /// Records the time in the state that the cell leaves, and the event.
    fn record_event(&mut self, index: usize, before: CellState, since: ReadingIndex, in_view: bool) {
        let last = self.last_reading(index);
        let period = self.times.period(last);
        let mut record = self.records.get(index);
        if record.slot.is_none() {
            record.slot = Some(self.changed.len() as Slot);
            self.changed.push(index as u32);
            self.flags[index].has_changed = true;
        }
        // The time since the first observation of the new state belongs to the new state.
        let until = since.clamp(record.since, last.max(record.since));
        let stayed = self.times.at(until) - self.times.at(record.since);
        let event = state_index(before); // free → blocked is a block event, blocked → free a free event
        record.watched[event] += stayed;
        if in_view
            && (record.is_whole && period > 0.0 && self.estimator.weighs_gaps())
            && let Some(gaps) = self.gaps.get_mut(index)
        {
            gaps.add_stay(event, stayed / period, &mut self.regularity);
        }
        record.is_whole = in_view;
        record.since = until;
        if in_view {
            record.in_view[event] += 1
        } else {
            record.after_gap[event] += 1
        }
        self.records.set(index, record);
    }

    /// Whether the cell still has the state of its first observation (not the state of a prior map) and was in view
    /// for less than `confirm` (in the time unit of the readings). A corrected state counts as confirmed: otherwise
    /// every change of a cell that changes faster than `confirm` would be a correction.
    pub fn is_unconfirmed(&self, index: usize, confirm: f64) -> bool {
        let record = self.records.get(index);
        let may_be = record.first > PRIOR && !record.was_corrected && !self.has_changed(index);
        may_be && self.statistics(index).observed() < confirm
    }

    /// Corrects a wrong first observation: nothing changed; the state of the cell was `after` from the start.
    pub fn correct(&mut self, index: usize, after: CellState) {
        let now = self.reading();
        self.observe(index);
        self.records.set(index, Record { was_corrected: true, ..Record::since(now) });
        if let Some(gaps) = self.gaps.changed_mut(index) {
            *gaps = CellGaps::default();
        }
        let (cell, before) = (self.frame().cell(index), self.state(index));
        self.transitions.push(Transition { cell, before, after: CellState::Unknown });
        self.states.cells_mut()[index] = CellState::Unknown;
        self.set_state(index, after, now, false);
    }

    /// Weighs the gaps of a cell that changes, if enough was observed since the gaps were last weighed.
    pub(super) fn weigh_gaps(&mut self, index: usize) {
        if !self.has_changed(index) || !self.estimator.weighs_gaps() {
            return;
        }
        let seen = self.statistics(index);
        if !self.gaps[index].is_due(&seen) {
            return;
        }
        let (frame, Cell { x, y }) = (self.frame(), self.frame().cell(index));
        let cells = (y - NEAR..=y + NEAR).flat_map(|y| (x - NEAR..=x + NEAR).map(move |x| Cell::new(x, y)));
        let others = cells.filter_map(|cell| frame.index(cell)).filter(|&other| other != index);
        let prior = neighbors::prior(
            self.gaps[index].weights().own,
            others.map(|other| self.gaps[other].weights().own),
        );
        if let Some(gaps) = self.gaps.get_mut(index) {
            gaps.weigh(&seen, prior, &self.regularity);
        }
    }
}

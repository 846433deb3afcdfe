//! Cells that take another state.

use super::record::{Record, place};
use super::{Ledger, PRIOR, ReadingIndex};
use crate::gaps::{Gaps, Near};
use interfaces::{Cell, CellState, Transition};

/// Cells as far as this from a cell, along either axis, tell how it may change.
const NEAR: i32 = 3;

impl Ledger {
    /// The cell takes another state. `since` is the reading in which the new state was first
    /// seen, and `in_view` says whether the old one was still seen in the reading before that:
    /// then the change happened in view, else it was found after a gap.
    pub(crate) fn turn(&mut self, index: usize, after: CellState, since: ReadingIndex, in_view: bool) {
        let before = self.state(index);
        let is_event = before != CellState::Unknown && self.records[index].is_known();
        if !self.was_seen_now(index) && !self.is_in_view(index) {
            self.end_gap(index, after);
            self.mark(index);
        } else if is_event && let Some(gaps) = self.gaps.get_mut(index) {
            gaps.correct_last(since, after == CellState::Blocked);
        }
        if is_event {
            self.book_event(index, before, since, in_view);
        }
        let cell = self.frame().cell(index);
        self.transitions.push(Transition { cell, before, after });
        self.states.cells_mut()[index] = after;
        if after == CellState::Blocked {
            self.set_settled(index, false);
        }
        self.see(index);
        self.weigh_gaps(index);
        self.judge_candidate(index);
        for neighbour in cell.neighbours4() {
            if let Some(neighbour) = self.frame().index(neighbour) {
                self.judge_candidate(neighbour);
            }
        }
    }

    /// Books the time in the state that a cell leaves, and that it leaves it.
    fn book_event(&mut self, index: usize, before: CellState, since: ReadingIndex, in_view: bool) {
        let last = self.last(index);
        let period = self.period(last);
        let record = &mut self.records[index];
        if !record.has_changed() {
            record.set_slot(self.survival.add(index));
        }
        // The time since the new state was first seen belongs to the new state.
        let until = since.clamp(record.since, last.max(record.since));
        let stayed = self.times[until as usize] - self.times[record.since as usize];
        let event = place(before); // free → blocked is a block event, blocked → free a free event
        record.watched[event] += stayed;
        if let Some(gaps) = self.gaps.get_mut(index)
            && (in_view && record.is_whole && period > 0.0)
        {
            gaps.add_stay(event, stayed / period, &mut self.regularity);
        }
        record.is_whole = in_view;
        record.since = until;
        if in_view { record.in_view[event] += 1 } else { record.after_gap[event] += 1 }
    }

    /// Whether the cell is still in the state of its first sighting, which was not that of a prior map,
    /// and was watched in it for less than `confirm` (in the unit of the readings' times).
    pub(crate) fn is_unconfirmed(&self, index: usize, confirm: f64) -> bool {
        let seen = self.statistics(index);
        self.records[index].first > PRIOR && seen.events() == 0 && seen.observed() < confirm
    }

    /// The first sighting of the cell was wrong: nothing changed, it was `after` all along.
    pub(crate) fn correct(&mut self, index: usize, after: CellState) {
        let now = self.now_index();
        self.see(index);
        self.records[index] = Record::since(now);
        if let Some(gaps) = self.gaps.get_mut(index) {
            *gaps = Gaps::default();
        }
        let (cell, before) = (self.frame().cell(index), self.state(index));
        self.transitions.push(Transition { cell, before, after: CellState::Unknown });
        self.states.cells_mut()[index] = CellState::Unknown;
        self.turn(index, after, now, false);
    }

    /// Lets the estimator weigh the gaps of a cell that changes, when enough has been seen since it
    /// last did.
    pub(super) fn weigh_gaps(&mut self, index: usize) {
        if self.gaps.is_empty() || !self.records[index].has_changed() {
            return;
        }
        let seen = self.statistics(index);
        if !self.gaps[index].is_due(&seen) {
            return;
        }
        let own = self.gaps[index].own();
        let frame = self.frame();
        let cell = frame.cell(index);
        let mut near = Near::of(own);
        for y in cell.y - NEAR..=cell.y + NEAR {
            for x in cell.x - NEAR..=cell.x + NEAR {
                if let Some(other) = frame.index(Cell::new(x, y))
                    && other != index
                {
                    near.add(self.gaps[other].own());
                }
            }
        }
        let near = near.prior();
        self.gaps[index].weigh(self.estimator, &seen, near, &self.regularity);
    }
}

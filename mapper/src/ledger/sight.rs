//! Cells that are seen, and found as they were.

use super::record::place;
use super::{Ledger, PRIOR, ReadingIndex};
use interfaces::{Cell, CellState};

/// Set in the number of a cell's last sighting while the cell needs a closer look at every
/// sighting; see [`Ledger::see_run`].
pub(super) const UNSETTLED: ReadingIndex = 1 << 31;
/// Cells that [`Ledger::see_run`] takes at once.
const BLOCK: usize = 16;

impl Ledger {
    /// The reading that last saw the cell.
    #[inline]
    pub(super) fn last(&self, index: usize) -> ReadingIndex {
        self.sightings[index] & !UNSETTLED
    }

    #[inline]
    pub(crate) fn was_seen_now(&self, index: usize) -> bool {
        self.last(index) == self.now_index()
    }

    /// Whether the cell was in view when the open reading came: it was seen in the one before, or not
    /// longer ago than the gap that does not count as one.
    #[inline]
    pub(crate) fn is_in_view(&self, index: usize) -> bool {
        let (now, last) = (self.now_index(), self.last(index));
        if last == now {
            return self.records[index].since < now; // its watch did not begin just now
        }
        last + 1 == now
            || self.max_gap > 0.0 && last > PRIOR && self.now() - self.times[last as usize] <= self.max_gap
    }

    /// Marks a cell as simply free, or as one to look at closer.
    #[inline]
    pub(crate) fn set_settled(&mut self, index: usize, is_settled: bool) {
        let last = self.last(index);
        self.sightings[index] = if is_settled { last } else { last | UNSETTLED };
    }

    /// The cell was observed in the open reading. Writes one number where the cell was in view
    /// before; only at a gap is the time up to the gap booked.
    #[inline]
    pub(crate) fn see(&mut self, index: usize) {
        if self.was_seen_now(index) {
            return;
        }
        if !self.is_in_view(index) {
            self.end_gap(index, self.state(index));
            self.weigh_gaps(index);
        }
        self.mark(index);
    }

    /// Notes that the open reading saw the cell, which it had not yet.
    #[inline]
    pub(super) fn mark(&mut self, index: usize) {
        let (now, last) = (self.now_index(), self.last(index));
        self.sightings[index] = now | self.sightings[index] & UNSETTLED;
        if self.candidates[index] {
            self.recency.moved(last, now);
        }
        if last + 1 < now
            && let Some(slot) = self.records[index].slot()
        {
            self.survival.came_back(slot);
        }
    }

    /// The cells of one row from `start` to `end` (places in row-major order) were seen through in
    /// the open reading. Where they are settled, and were in view before, one number per cell
    /// changes; the others are listed in `closer`. Most of a scan is of the first kind, so it goes
    /// block by block, without a branch per cell.
    #[inline]
    pub(crate) fn see_run(&mut self, start: usize, end: usize, closer: &mut Vec<u32>) {
        let now = self.now_index();
        let mut again = 0;
        let mut block_start = start;
        for block in self.sightings[start..end].chunks_mut(BLOCK) {
            // No early exit: the comparison of a whole block vectorises.
            if block.len() == BLOCK && block.iter().fold(true, |all, &last| all & (last == now - 1)) {
                block.fill(now);
                again += BLOCK as u32;
            } else {
                for (offset, last) in block.iter_mut().enumerate() {
                    if *last == now - 1 {
                        *last = now;
                        again += 1;
                    } else if *last != now {
                        closer.push((block_start + offset) as u32);
                    }
                }
            }
            block_start += BLOCK;
        }
        // A settled cell is free, and a free cell is a candidate.
        self.recency.seen_again(again);
    }

    /// The open reading tells the states of cells outright. Cells outside of the map are left out.
    pub(crate) fn see_states(&mut self, cells: &[(Cell, bool)]) {
        let frame = *self.frame();
        let now = self.now_index();
        let mut again = 0;
        for &(cell, is_blocked) in cells {
            let Some(index) = frame.index(cell) else { continue };
            let state = if is_blocked { CellState::Blocked } else { CellState::Free };
            let is_as_before = self.state(index) == state;
            // Most cells were in view before and are as they were.
            if is_as_before && self.last(index) == now - 1 {
                self.sightings[index] += 1;
                again += u32::from(self.candidates[index]);
                continue;
            }
            self.recency.seen_again(std::mem::take(&mut again));
            if is_as_before {
                self.see(index);
            } else {
                self.turn(index, state, now, self.is_in_view(index));
            }
        }
        self.recency.seen_again(again);
    }

    /// The cell is seen again after a gap, or for the first time: books what was seen before.
    pub(super) fn end_gap(&mut self, index: usize, after: CellState) {
        let (before, last, now) = (self.state(index), self.last(index), self.now_index());
        let record = &mut self.records[index];
        if record.is_known() {
            let length = self.times[now as usize] - self.times[last as usize];
            record.watched[place(before)] += self.times[last as usize] - self.times[record.since as usize];
            record.gaps[place(before)] += 1;
            if let Some(gaps) = self.gaps.get_mut(index) {
                gaps.add([last, now], length, [before, after].map(|state| state == CellState::Blocked));
            }
        } else {
            record.first = now;
        }
        record.since = now;
        record.is_whole = false;
    }
}

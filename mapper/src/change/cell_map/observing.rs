//! Cells that are observed in the same state as before.

use super::record::{Flags, state_index};
use super::{CellMap, PRIOR, ReadingIndex};
use crate::change::gaps::Gap;
use interfaces::{Cell, CellState};

/// Set in the last reading of a cell that is not settled; see [`CellMap::observe_run`].
pub(super) const UNSETTLED: ReadingIndex = 1 << 31;
/// The number of cells that [`CellMap::observe_run`] processes at once: at most those of a row in a block of
/// [`interfaces::SparseCells`].
const BLOCK: usize = 16;

impl CellMap {
    /// The last reading that observed the cell.
    #[inline]
    pub(super) fn last_reading(&self, index: usize) -> ReadingIndex {
        self.observed[index] & !UNSETTLED
    }

    /// Whether the open reading observed the cell.
    #[inline]
    pub fn is_seen_now(&self, index: usize) -> bool {
        self.last_reading(index) == self.reading()
    }

    /// Whether a reading after this one observed the cell.
    #[inline]
    pub fn was_seen_after(&self, index: usize, reading: ReadingIndex) -> bool {
        self.last_reading(index) > reading
    }

    /// Whether the cell was in view when the open reading came: the last observation of the cell was made by the
    /// reading before, or at most [`MapperSettings::max_gap`](crate::MapperSettings::max_gap) ago, and all readings since
    /// had a certain pose.
    #[inline]
    pub fn is_in_view(&self, index: usize) -> bool {
        let (now, last) = (self.reading(), self.last_reading(index));
        if last == now {
            return self.records.since(index) < now; // its view did not begin just now
        }
        last + 1 == now
            || self.max_gap > 0.0
                && last > PRIOR.max(self.interrupted)
                && self.time() - self.times.at(last) <= self.max_gap
    }

    /// Loads what an observation of these cells reads. The cells at the border of a view are far apart in memory: in a short
    /// loop of its own, the processor loads those of many cells side by side, and not one after the other.
    #[inline]
    pub(crate) fn load(&self, cells: impl Iterator<Item = usize>) {
        let load = |index: usize| {
            let Flags { is_candidate, has_changed } = self.flags[index];
            self.observed[index] ^ self.state(index) as u32 ^ u32::from(is_candidate ^ has_changed)
        };
        std::hint::black_box(cells.fold(0, |loaded, index| loaded ^ load(index)));
    }

    /// Whether a cell can be seen. When the [memory is used up](crate::Mapper::is_full), cells far from those that were seen cannot: an
    /// occupancy model treats them as cells outside of the map.
    #[inline]
    pub fn covers(&self, index: usize) -> bool {
        !self.is_full || self.observed.is_stored(index)
    }

    /// Marks a free cell as settled: [`observe_run`](Self::observe_run) then updates it at once. A cell that becomes
    /// blocked is no longer settled.
    #[inline]
    pub fn set_settled(&mut self, index: usize, is_settled: bool) {
        let last = self.last_reading(index);
        self.observed.set(index, if is_settled { last } else { last | UNSETTLED });
    }

    /// The open reading observed the cell in the same state as before. After a gap, the time up to the gap is
    /// recorded.
    #[inline]
    pub fn observe(&mut self, index: usize) {
        let (now, stored) = (self.reading(), self.observed[index]);
        let last = stored & !UNSETTLED;
        if last == now {
            return;
        }
        if last + 1 == now {
            // Most cells: only the reading changes.
            self.observed[index] = stored + 1;
            let again = u32::from(self.flags[index].is_candidate);
            self.last_seen_counts.observed_again(again);
            return;
        }
        if !self.is_in_view(index) {
            self.end_gap(index, self.state(index));
            self.weigh_gaps(index);
        }
        self.mark(index);
    }

    /// Observes a [settled](Self::set_settled) cell that never changed and was in view: only its last reading changes. Returns
    /// false, and changes nothing, if the cell is not one of these.
    #[inline]
    pub(crate) fn observe_settled(&mut self, index: usize) -> bool {
        let (now, last) = (self.reading(), self.observed[index]);
        if last == now {
            return true;
        }
        let Flags { is_candidate, has_changed } = self.flags[index];
        if last & UNSETTLED != 0 || has_changed || !self.is_in_view(index) {
            return false;
        }
        self.observed[index] = now;
        if is_candidate {
            self.last_seen_counts.moved(last, now);
        }
        true
    }

    /// Records that the open reading observed the cell for the first time.
    #[inline]
    pub(super) fn mark(&mut self, index: usize) {
        let (now, last) = (self.reading(), self.last_reading(index));
        self.observed[index] = now | self.observed[index] & UNSETTLED;
        let flags = self.flags[index];
        if flags.is_candidate {
            self.last_seen_counts.moved(last, now);
        }
        if flags.has_changed
            && last + 1 < now
            && let Some(slot) = self.slot(index)
        {
            self.returned.push(slot);
        }
    }

    /// The open reading observed the cells of one row from `start` up to, but not including, `end`, and found them
    /// free. Cells that are [settled](Self::set_settled) and were in view before are updated here; the others are
    /// appended to `closer`. Most cells of a scan are settled, so that the loop goes block by block, without a
    /// branch per cell.
    #[inline]
    pub fn observe_run(&mut self, start: usize, end: usize, closer: &mut Vec<u32>) {
        let (now, is_full) = (self.reading(), self.is_full);
        let (before, mut again) = (now - 1, 0);
        self.observed.each_piece_mut(start, end, |from, until, block| {
            let Some(block) = block else {
                let unseen = if is_full { 0..0 } else { from as u32..until as u32 };
                return closer.extend(unseen);
            };
            for (number, block) in block.chunks_mut(BLOCK).enumerate() {
                // No early exit: the comparison of a whole block vectorizes.
                if block.len() == BLOCK && block.iter().fold(true, |all, &last| all & (last == before)) {
                    block.fill(now);
                    again += BLOCK as u32;
                    continue;
                }
                let from = from + number * BLOCK;
                for (offset, last) in block.iter_mut().enumerate() {
                    if *last == before {
                        *last = now;
                        again += 1;
                    } else if *last != now {
                        closer.push((from + offset) as u32);
                    }
                }
            }
        });
        // A settled cell is free, and a free cell is a candidate.
        self.last_seen_counts.observed_again(again);
    }

    /// The open reading observed the states of these cells without error. Cells outside of the map are ignored.
    pub fn observe_states(&mut self, cells: &[(Cell, bool)]) {
        let frame = *self.frame();
        let now = self.reading();
        let mut again = 0;
        for &(cell, is_blocked) in cells {
            let Some(index) = frame.index(cell).filter(|index| self.covers(*index)) else { continue };
            let state = if is_blocked { CellState::Blocked } else { CellState::Free };
            let is_as_before = self.state(index) == state;
            // Most cells were in view before and have the same state as before.
            if is_as_before && self.last_reading(index) == now - 1 {
                self.observed[index] += 1;
                again += u32::from(self.flags[index].is_candidate);
                continue;
            }
            self.last_seen_counts.observed_again(std::mem::take(&mut again));
            if is_as_before {
                self.observe(index);
            } else {
                self.set_state(index, state, now, self.is_in_view(index));
            }
        }
        self.last_seen_counts.observed_again(again);
    }

    /// The cell is observed again after a gap, or for the first time: records the time before.
    pub(super) fn end_gap(&mut self, index: usize, after: CellState) {
        let (before, last, now) = (self.state(index), self.last_reading(index), self.reading());
        let mut record = self.records.get(index);
        if record.is_known() {
            let length = self.times.at(now) - self.times.at(last);
            record.watched[state_index(before)] += self.times.at(last) - self.times.at(record.since);
            if self.estimator.weighs_gaps()
                && let Some(gaps) = self.gaps.get_mut(index)
            {
                let [before, after] = [before, after].map(|state| state == CellState::Blocked);
                let owned = gaps.histogram.owned_bytes();
                gaps.histogram.add(Gap { start: last, end: now, length, before, after });
                self.gap_bytes += gaps.histogram.owned_bytes() - owned;
            }
        } else {
            record.first = now;
        }
        record.since = now;
        record.is_whole = false;
        self.records.set(index, record);
    }
}

//! The longest time since a candidate was observed, without a pass over the map.

use super::{NEVER, ReadingIndex};
use std::collections::VecDeque;

/// For each reading from `oldest` on, the number of candidates that were last observed by that reading.
#[derive(Clone, Debug)]
pub(super) struct LastSeenCounts {
    counts: VecDeque<u32>,
    oldest: ReadingIndex,
}

impl Default for LastSeenCounts {
    /// Counts nothing; the readings "never" and "prior" are open.
    fn default() -> Self {
        Self { counts: VecDeque::from([0, 0]), oldest: NEVER }
    }
}

impl LastSeenCounts {
    /// Opens the next reading.
    pub(super) fn open(&mut self) {
        self.counts.push_back(0);
    }

    /// A candidate that was last observed by reading `from` has now been observed by reading `to`.
    #[inline]
    pub(super) fn moved(&mut self, from: ReadingIndex, to: ReadingIndex) {
        self.counts[(from - self.oldest) as usize] -= 1;
        self.counts[(to - self.oldest) as usize] += 1;
    }

    /// The open reading observed this number of candidates again; the reading before had observed them, too.
    #[inline]
    pub(super) fn observed_again(&mut self, candidates: u32) {
        let newest = self.counts.len() - 1;
        self.counts[newest] += candidates;
        self.counts[newest - 1] -= candidates;
    }

    /// A cell that was last observed by reading `last` became a candidate, or stopped being one.
    pub(super) fn count(&mut self, last: ReadingIndex, is_candidate: bool) {
        // `oldest` passes a reading only when no candidate was last observed by it; a cell that becomes a
        // candidate again can go back further.
        while last < self.oldest {
            self.counts.push_front(0);
            self.oldest -= 1;
        }
        let count = &mut self.counts[(last - self.oldest) as usize];
        if is_candidate { *count += 1 } else { *count -= 1 }
    }

    /// The last reading of the candidate with the longest time since its last observation. Removes readings by
    /// which no candidate was last observed.
    pub(super) fn oldest(&mut self) -> Option<ReadingIndex> {
        while self.counts.len() > 2 && self.counts[0] == 0 {
            self.counts.pop_front();
            self.oldest += 1;
        }
        self.counts.iter().position(|&count| count > 0).map(|offset| self.oldest + offset as ReadingIndex)
    }
}

//! The longest time since a candidate was seen, without a pass over the map.

use super::{NEVER, ReadingIndex};
use std::collections::VecDeque;

/// For each reading from `oldest` on, the number of candidates last seen in it.
#[derive(Clone, Debug)]
pub(super) struct Recency {
    counts: VecDeque<u32>,
    oldest: ReadingIndex,
}

impl Default for Recency {
    /// With nothing counted, and the readings "never" and "prior" open.
    fn default() -> Self {
        Self { counts: VecDeque::from([0, 0]), oldest: NEVER }
    }
}

impl Recency {
    /// Opens the next reading.
    pub(super) fn open(&mut self) {
        self.counts.push_back(0);
    }

    /// A candidate last seen in `from` was seen in `to`.
    #[inline]
    pub(super) fn moved(&mut self, from: ReadingIndex, to: ReadingIndex) {
        self.counts[(from - self.oldest) as usize] -= 1;
        self.counts[(to - self.oldest) as usize] += 1;
    }

    /// So many candidates that the reading before the open one saw were seen again.
    #[inline]
    pub(super) fn seen_again(&mut self, candidates: u32) {
        let newest = self.counts.len() - 1;
        self.counts[newest] += candidates;
        self.counts[newest - 1] -= candidates;
    }

    /// A cell last seen in `last` became a candidate, or is none any more.
    pub(super) fn count(&mut self, last: ReadingIndex, is_candidate: bool) {
        // A cell seen before every reading that still counts cannot lie before `oldest`: candidates
        // hold `oldest` back, and a cell that becomes one again is counted where it was last seen.
        while last < self.oldest {
            self.counts.push_front(0);
            self.oldest -= 1;
        }
        let count = &mut self.counts[(last - self.oldest) as usize];
        if is_candidate { *count += 1 } else { *count -= 1 }
    }

    /// The reading that last saw the candidate that was not seen for longest. Forgets readings that no
    /// candidate was last seen in.
    pub(super) fn longest(&mut self) -> Option<ReadingIndex> {
        while self.counts.len() > 2 && self.counts[0] == 0 {
            self.counts.pop_front();
            self.oldest += 1;
        }
        self.counts.iter().position(|&count| count > 0).map(|offset| self.oldest + offset as ReadingIndex)
    }
}

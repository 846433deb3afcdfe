//! The longest time since a candidate was observed, without a pass over the map.

use super::{NEVER, ReadingIndex};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, VecDeque};

/// The number of recent readings that are counted one by one, with or without a candidate.
const MAX_RECENT: usize = 1 << 14;

/// For each reading, the number of candidates that were last observed by that reading.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(super) struct LastSeenCounts {
    /// For the readings before `start`; only numbers above 0. A candidate that is never observed again does not need
    /// more memory with every reading.
    old: BTreeMap<ReadingIndex, u32>,
    /// For each reading from `start` on.
    recent: VecDeque<u32>,
    start: ReadingIndex,
}

impl Default for LastSeenCounts {
    /// Counts nothing; the readings "never" and "prior" are open.
    fn default() -> Self {
        Self { old: BTreeMap::new(), recent: VecDeque::from([0, 0]), start: NEVER }
    }
}

impl LastSeenCounts {
    /// Whether these are the counts of candidates with these last readings, up to the reading that is open.
    pub(super) fn is_sound(
        &self,
        candidates: impl Iterator<Item = ReadingIndex>,
        open: ReadingIndex,
    ) -> bool {
        let mut counts = BTreeMap::new();
        candidates.for_each(|reading| *counts.entry(reading).or_default() += 1);
        let recent = (self.start..=open).zip(&self.recent).filter(|(_, count)| **count > 0);
        let end = self.start as usize + self.recent.len();
        let known: BTreeMap<ReadingIndex, u32> = recent.map(|(reading, count)| (reading, *count)).collect();
        self.recent.len() >= 2
            && end == open as usize + 1
            && self.old.clone().into_iter().chain(known).eq(counts)
    }

    /// Opens the next reading.
    pub(super) fn open(&mut self) {
        self.recent.push_back(0);
        if self.recent.len() > MAX_RECENT {
            self.pass_first();
        }
    }

    /// Moves the first of the recent readings to the old ones.
    fn pass_first(&mut self) {
        if let Some(count) = self.recent.pop_front().filter(|&count| count > 0) {
            self.old.insert(self.start, count);
        }
        self.start += 1;
    }

    /// A candidate that was last observed by reading `from` has now been observed by reading `to`.
    #[inline]
    pub(super) fn moved(&mut self, from: ReadingIndex, to: ReadingIndex) {
        self.count(from, false);
        self.count(to, true);
    }

    /// The open reading observed this number of candidates again; the reading before had observed them, too.
    #[inline]
    pub(super) fn observed_again(&mut self, candidates: u32) {
        let newest = self.recent.len() - 1;
        self.recent[newest] += candidates;
        self.recent[newest - 1] -= candidates;
    }

    /// A cell that was last observed by reading `last` became a candidate, or stopped being one.
    #[inline]
    pub(super) fn count(&mut self, last: ReadingIndex, is_candidate: bool) {
        let Some(offset) = last.checked_sub(self.start) else { return self.count_old(last, is_candidate) };
        let count = &mut self.recent[offset as usize];
        if is_candidate { *count += 1 } else { *count -= 1 }
    }

    fn count_old(&mut self, last: ReadingIndex, is_candidate: bool) {
        match self.old.entry(last) {
            Entry::Vacant(entry) => drop(entry.insert(u32::from(is_candidate))),
            Entry::Occupied(mut entry) if is_candidate => *entry.get_mut() += 1,
            Entry::Occupied(entry) if *entry.get() == 1 => drop(entry.remove()),
            Entry::Occupied(mut entry) => *entry.get_mut() -= 1,
        }
    }

    /// The last reading of the candidate with the longest time since its last observation. Passes readings by which
    /// no candidate was last observed.
    pub(super) fn oldest(&mut self) -> Option<ReadingIndex> {
        if let Some((&oldest, _)) = self.old.first_key_value() {
            return Some(oldest);
        }
        while self.recent.len() > 2 && self.recent[0] == 0 {
            self.pass_first();
        }
        self.recent.iter().position(|&count| count > 0).map(|offset| self.start + offset as ReadingIndex)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidates_that_are_not_observed_again_need_no_memory_per_reading() {
        let mut counts = LastSeenCounts::default();
        counts.count(NEVER, true);
        counts.count(NEVER, true);
        let mut newest = 1;
        for _ in 0..100_000 {
            counts.open();
            newest += 1;
            // One more cell becomes a candidate now and then, and all of these are seen again later.
            if newest % 1000 == 0 {
                counts.count(newest, true);
            }
            if newest % 50_000 == 0 {
                let old = (1..=newest / 1000)
                    .map(|reading| reading * 1000)
                    .filter(|&reading| reading > newest - 50_000);
                old.filter(|&reading| reading < newest).for_each(|reading| counts.moved(reading, newest));
            }
            assert_eq!(counts.oldest(), Some(NEVER));
        }
        assert!(counts.recent.len() <= MAX_RECENT && counts.old.len() <= 3, "{} old", counts.old.len());
        counts.moved(NEVER, newest);
        counts.count(NEVER, false);
        assert_eq!(counts.oldest(), Some(50_000));
    }
}

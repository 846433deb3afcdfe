//! The times of all readings.

/// The number of a reading. Number 0 means "never"; its time is 0, and a cell that was never observed counts as
/// last seen then. Number 1 is the prior map, also at time 0. No cell counts as last seen in reading 1, so that the
/// first reading of a cell always follows a gap.
pub type ReadingIndex = u32;
pub(super) const NEVER: ReadingIndex = 0;
pub(super) const PRIOR: ReadingIndex = 1;

/// What a state can hold: readings of four years at 10 Hz, and times far beyond any calendar, s.
const MAX_READINGS: ReadingIndex = 1 << 30;
const MAX_TIME_S: f64 = 1e15;
/// The number of recent readings whose times are all kept, at least half of it at any time: almost two hours at 10 Hz.
const MAX_RECENT: usize = 1 << 16;

/// The times of readings, by [`ReadingIndex`], in bounded memory: those of recent readings, and of older readings those
/// that are in use.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(super) struct ReadingTimes {
    /// The older readings in use, in order, and their times.
    old: Vec<(ReadingIndex, f64)>,
    /// The times of all readings from `start` on.
    recent: Vec<f64>,
    start: ReadingIndex,
    /// The time of the first reading after the prior.
    first: f64,
    /// For each pause between two sessions: the first reading after it, and the sum of the pauses up to it.
    pauses: Vec<(ReadingIndex, f64)>,
}

impl Default for ReadingTimes {
    fn default() -> Self {
        Self { old: Vec::new(), recent: vec![0.0, 0.0], start: NEVER, first: 0.0, pauses: Vec::new() }
    }
}

impl ReadingTimes {
    /// Whether every reading up to the last one has a time: a state can hold anything.
    pub(super) fn is_sound(&self) -> bool {
        let last = self.recent.len().checked_sub(1).and_then(|later| u32::try_from(later).ok());
        let last = last.and_then(|later| self.start.checked_add(later));
        let first = self.old.first().map_or(self.start, |(first, _)| *first);
        let starts = self.old.iter().map(|(reading, _)| *reading).chain([self.start]);
        let times = self.old.iter().map(|(_, time)| time).chain(&self.recent);
        let sums = self.pauses.iter().map(|(_, sum)| sum);
        let mut pauses = self.pauses.iter().map(|(reading, _)| *reading);
        last.is_some_and(|last| {
            (PRIOR..MAX_READINGS).contains(&last) && pauses.all(|after| (PRIOR..=last).contains(&after))
        }) && first == NEVER
            && starts.is_sorted_by(|before, after| before < after)
            && times.clone().is_sorted()
            && times.chain(sums).chain([&self.first]).all(|time| time.abs() <= MAX_TIME_S)
    }

    /// Begins the next reading.
    pub(super) fn push(&mut self, time: f64) {
        if self.last() == PRIOR {
            self.first = time;
        }
        self.recent.push(time);
    }

    /// Begins the first reading after a pause between two sessions: the pause counts as one step.
    pub(super) fn push_after_pause(&mut self, time: f64) {
        let last = self.last();
        let pause = if last > PRIOR { time - self.at(last) - self.period(last) } else { 0.0 };
        self.push(time);
        self.pauses.push((last + 1, pause + self.paused(last)));
    }

    /// The sum of the pauses up to a reading.
    fn paused(&self, until: ReadingIndex) -> f64 {
        let count = self.pauses.partition_point(|&(first, _)| first <= until);
        self.pauses[..count].last().map_or(0.0, |&(_, sum)| sum)
    }

    /// The time of a reading. That of a reading that was forgotten is between those of the readings around it, as if
    /// readings came regularly there.
    #[inline]
    pub(super) fn at(&self, reading: ReadingIndex) -> f64 {
        match reading.checked_sub(self.start) {
            Some(offset) => self.recent[offset as usize],
            None => self.old_at(reading),
        }
    }

    fn old_at(&self, reading: ReadingIndex) -> f64 {
        let next = self.old.partition_point(|&(kept, _)| kept < reading);
        let (after, after_time) = self.old.get(next).copied().unwrap_or((self.start, self.recent[0]));
        if after == reading {
            return after_time;
        }
        let (before, before_time) = self.old[next - 1]; // the reading "never" is never forgotten
        let share = f64::from(reading - before) / f64::from(after - before);
        before_time + share * (after_time - before_time)
    }

    /// The last reading.
    #[inline]
    pub(super) fn last(&self) -> ReadingIndex {
        self.start + (self.recent.len() - 1) as ReadingIndex
    }

    /// The mean time between consecutive readings, up to `until`, without pauses; 0 before the second reading.
    pub(super) fn period(&self, until: ReadingIndex) -> f64 {
        let first = PRIOR + 1;
        if until <= first {
            return 0.0;
        }
        (self.at(until) - self.first - self.paused(until)) / f64::from(until - first)
    }

    /// Whether it is time to [`forget`](Self::forget).
    pub(super) fn is_full(&self) -> bool {
        self.recent.len() >= MAX_RECENT
    }

    /// Forgets the times of the older half of the recent readings, and those of old readings, but for those `in_use`.
    pub(super) fn forget(&mut self, in_use: impl Iterator<Item = ReadingIndex>) {
        let mut is_in_use = vec![false; self.old.len() + MAX_RECENT / 2];
        let around_pauses = self.pauses.iter().flat_map(|&(first, _)| [first - 1, first]);
        for reading in in_use.chain(around_pauses).chain([NEVER]) {
            let slot = match reading.checked_sub(self.start) {
                Some(offset) => Ok(self.old.len() + offset as usize),
                None => self.old.binary_search_by_key(&reading, |&(kept, _)| kept),
            };
            if let Some(is) = slot.ok().and_then(|slot| is_in_use.get_mut(slot)) {
                *is = true;
            }
        }
        let passed = self.recent.drain(..MAX_RECENT / 2);
        self.old.extend((self.start..).zip(passed));
        self.start += (MAX_RECENT / 2) as ReadingIndex;
        let mut is_in_use = is_in_use.into_iter();
        self.old.retain(|_| is_in_use.next() == Some(true));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_in_use_stay_exact_and_the_others_are_forgotten() {
        let time = |reading: ReadingIndex| 0.05 * f64::from(2 * reading.saturating_sub(PRIOR + 1)) + 3.0;
        let mut times = ReadingTimes::default();
        let in_use = [2, 7, 30_000, 40_000, 99_999, 250_000];
        for reading in 2..300_000 {
            if times.is_full() {
                times.forget(in_use.into_iter().chain([reading - 1]));
            }
            times.push(time(reading));
            assert_eq!((times.last(), times.at(reading)), (reading, time(reading)));
            assert!(times.old.len() <= in_use.len() + 9 && times.recent.len() <= MAX_RECENT);
        }
        for reading in in_use.into_iter().chain(299_999 - 32_768..300_000) {
            assert_eq!(times.at(reading), time(reading), "reading {reading}");
        }
        assert_eq!((times.at(NEVER), times.period(299_999)), (0.0, (time(299_999) - 3.0) / 299_997.0));
        // A forgotten time follows from its neighbors.
        for reading in [31_000, 200_000] {
            assert!((times.at(reading) - time(reading)).abs() < 1e-6, "reading {reading}");
        }
    }
}

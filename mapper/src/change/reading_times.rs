//! The times of all readings.

/// The number of a reading. Number 0 means "never"; its time is 0, and a cell that was never observed counts as
/// last seen then. Number 1 is the prior map, also at time 0. No cell counts as last seen in reading 1, so that the
/// first reading of a cell always follows a gap.
pub type ReadingIndex = u32;
pub(super) const NEVER: ReadingIndex = 0;
pub(super) const PRIOR: ReadingIndex = 1;

/// The time of every reading, by [`ReadingIndex`].
#[derive(Clone, Debug)]
pub(super) struct ReadingTimes(Vec<f64>);

impl Default for ReadingTimes {
    fn default() -> Self {
        Self(vec![0.0, 0.0])
    }
}

impl ReadingTimes {
    /// Begins the next reading.
    pub(super) fn push(&mut self, time: f64) {
        self.0.push(time);
    }

    /// The time of a reading.
    #[inline]
    pub(super) fn at(&self, reading: ReadingIndex) -> f64 {
        self.0[reading as usize]
    }

    /// The last reading.
    #[inline]
    pub(super) fn last(&self) -> ReadingIndex {
        (self.0.len() - 1) as ReadingIndex
    }

    /// The mean time between consecutive readings, up to `until`; 0 before the second reading.
    pub(super) fn period(&self, until: ReadingIndex) -> f64 {
        let first = PRIOR + 1;
        if until <= first {
            return 0.0;
        }
        (self.at(until) - self.at(first)) / f64::from(until - first)
    }
}

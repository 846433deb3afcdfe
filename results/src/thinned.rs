//! Series in bounded memory.

use nalgebra::Point2;

/// The positions of goals, m: all goals of about ten hours.
pub type Goals = Thinned<Point2<f64>, 2048>;

/// A series of at most `MAX` samples, an even number. When the series is full, every second sample is dropped, and
/// from then on half as many samples are kept. The samples that are kept are therefore spread evenly over the whole
/// run. The first sample and the newest sample are always kept.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub struct Thinned<T, const MAX: usize> {
    samples: Vec<T>,
    /// One in this many samples is kept.
    stride: u64,
    count: u64,
}

impl<T, const MAX: usize> Default for Thinned<T, MAX> {
    fn default() -> Self {
        const { assert!(MAX >= 2 && MAX.is_multiple_of(2), "half of the samples are dropped at a time") };
        Self { samples: Vec::new(), stride: 1, count: 0 }
    }
}

impl<T, const MAX: usize> Thinned<T, MAX> {
    /// Appends the newest sample.
    pub fn push(&mut self, sample: T) {
        // The newest sample so far was kept only as the newest one.
        if self.count > 0 && !(self.count - 1).is_multiple_of(self.stride) {
            self.samples.pop();
        }
        if self.samples.len() == MAX {
            let mut is_kept = false;
            self.samples.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
            self.stride *= 2;
        }
        self.samples.push(sample);
        self.count += 1;
    }

    /// The samples that are kept, in order. All of them, as long as there were at most `MAX`.
    pub fn samples(&self) -> &[T] {
        &self.samples
    }

    /// The number of all samples, kept or not.
    pub fn count(&self) -> u64 {
        self.count
    }
}

impl<T, const MAX: usize> Extend<T> for Thinned<T, MAX> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, samples: I) {
        samples.into_iter().for_each(|sample| self.push(sample));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(count: u64) -> Thinned<u64, 8> {
        let mut series = Thinned::default();
        series.extend(0..count);
        series
    }

    #[test]
    fn a_short_series_is_complete() {
        for count in 0..=8 {
            assert_eq!(series(count).samples(), (0..count).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_long_series_is_spread_evenly_and_ends_with_the_newest_sample() {
        assert_eq!(series(9).samples(), [0, 2, 4, 6, 8]);
        assert_eq!(series(10).samples(), [0, 2, 4, 6, 8, 9]);
        assert_eq!(series(15).samples(), [0, 2, 4, 6, 8, 10, 12, 14]);
        assert_eq!(series(16).samples(), [0, 4, 8, 12, 15]);
    }

    #[test]
    fn a_series_never_grows_beyond_its_limit() {
        let mut series = Thinned::<u64, 8>::default();
        for newest in 0..10_000 {
            series.push(newest);
            let samples = series.samples();
            assert!(samples.len() <= 8 && (newest < 8 || samples.len() > 4), "{samples:?}");
            assert_eq!((samples.first(), samples.last()), (Some(&0), Some(&newest)));
            assert_eq!(series.count(), newest + 1);
            // All steps are equal, but for the last one, which is not longer.
            let steps: Vec<u64> = samples.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let Some((last, others)) = steps.split_last() else { continue };
            assert!(others.iter().all(|step| *step == steps[0]) && *last <= steps[0], "{samples:?}");
        }
    }
}

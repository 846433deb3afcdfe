//! Means with 95 % intervals, the paired t test, and Holm's correction for many tests.

use statrs::distribution::{ContinuousCDF, StudentsT};
use std::ops::RangeInclusive;

/// A mean and its 95 % confidence interval, which is cut to the values that the metric can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The number of values.
    pub count: usize,
    /// The mean of the values; NaN without values.
    pub mean: f64,
    /// The lower end of the 95 % confidence interval; NaN for fewer than two values.
    pub low: f64,
    /// The upper end of the 95 % confidence interval; NaN for fewer than two values.
    pub high: f64,
}

impl Estimate {
    /// The estimate of a value that is within `range`: Student's interval can reach beyond it.
    pub(super) fn within(self, range: RangeInclusive<f64>) -> Self {
        let cut = |end: f64| end.clamp(*range.start(), *range.end()); // NaN stays NaN
        // Also the mean: rounding can take it beyond the range.
        Self { mean: cut(self.mean), low: cut(self.low), high: cut(self.high), ..self }
    }
}

/// A mean difference of pairs, with the paired t test of the hypothesis that it is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PairedTest {
    pub(super) difference: Estimate,
    /// Two-sided; NaN for fewer than two pairs.
    pub(super) p_value: f64,
    /// Cohen's d of pairs: the mean difference in standard deviations of the differences.
    pub(super) effect_size: f64,
}

/// The 97.5 % points of Student's t, one per number of values, cached because each costs an iteration.
pub(super) struct Quantiles(Vec<f64>);

impl Quantiles {
    /// For up to `count` values.
    pub(super) fn up_to(count: usize) -> Self {
        let quantile = |count| student(count).map_or(f64::NAN, |student| student.inverse_cdf(0.975));
        Self((0..=count).map(quantile).collect())
    }

    /// The mean of `values` with its interval. NaN is left out.
    pub(super) fn estimate(&self, values: impl Iterator<Item = f64> + Clone) -> Estimate {
        let (estimate, _) = self.estimate_and_deviation(values);
        estimate
    }

    /// The estimate, and the standard deviation of the values.
    fn estimate_and_deviation(&self, values: impl Iterator<Item = f64> + Clone) -> (Estimate, f64) {
        let values = values.filter(|value| !value.is_nan());
        let (count, mean) = count_and_mean(values.clone());
        if count < 2 {
            return (Estimate { count, mean, low: f64::NAN, high: f64::NAN }, f64::NAN);
        }
        let squares: f64 = values.map(|value| (value - mean) * (value - mean)).sum();
        let deviation = (squares / (count - 1) as f64).sqrt();
        let half_width = self.0[count] * deviation / (count as f64).sqrt();
        (Estimate { count, mean, low: mean - half_width, high: mean + half_width }, deviation)
    }

    /// Tests whether the mean of the `differences` within pairs is zero.
    pub(super) fn paired_test(&self, differences: impl Iterator<Item = f64> + Clone) -> PairedTest {
        let (difference, deviation) = self.estimate_and_deviation(differences);
        let Estimate { count, mean, .. } = difference;
        let (p_value, effect_size) = match student(count) {
            None => (f64::NAN, f64::NAN),
            // Nothing differs anywhere: 0/0 would be NaN.
            Some(_) if mean == 0.0 && deviation == 0.0 => (1.0, 0.0),
            Some(student) => {
                let effect_size = mean / deviation;
                (2.0 * student.sf((effect_size * (count as f64).sqrt()).abs()), effect_size)
            }
        };
        PairedTest { difference, p_value, effect_size }
    }
}

/// Student's t of a mean of `count` values; `None` for fewer than two.
fn student(count: usize) -> Option<StudentsT> {
    StudentsT::new(0.0, 1.0, count.checked_sub(1)? as f64).ok()
}

/// The mean of `values`, without NaN.
pub(super) fn mean(values: impl Iterator<Item = f64>) -> f64 {
    count_and_mean(values.filter(|value| !value.is_nan())).1
}

fn count_and_mean(values: impl Iterator<Item = f64>) -> (usize, f64) {
    let (count, sum) = values.fold((0, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count, sum / count as f64)
}

/// Holm's correction of the p-values of a family of tests, in their order (Holm, 1979). NaN stays NaN and does not
/// count as a test.
pub(super) fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p_values.len()).filter(|&test| !p_values[test].is_nan()).collect();
    order.sort_by(|&a, &b| p_values[a].total_cmp(&p_values[b]));
    let mut corrected = vec![f64::NAN; p_values.len()];
    let mut least = 0.0_f64;
    for (rank, &test) in order.iter().enumerate() {
        least = least.max(p_values[test] * (order.len() - rank) as f64).min(1.0);
        corrected[test] = least;
    }
    corrected
}

//! Means with 95 % intervals, the paired t test, and Holm's correction for many tests.

use statrs::distribution::{ContinuousCDF, StudentsT};
use std::cell::RefCell;
use std::collections::BTreeMap;
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
pub struct PairedTest {
    /// The mean difference.
    pub difference: Estimate,
    /// Two-sided; NaN for fewer than two pairs.
    pub p_value: f64,
    /// Cohen's d of pairs: the mean difference in standard deviations of the differences.
    pub effect_size: f64,
}

/// Tests whether the mean of the `differences` within pairs is zero.
pub fn paired_test(differences: impl Iterator<Item = f64>) -> PairedTest {
    Quantiles::default().paired_test(differences)
}

/// Count, mean and deviation of values that arrive one by one (Welford, 1962). NaN is left out.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    count: usize,
    sum: f64,
    /// The mean so far, from which the next value deviates; the sum gives the mean with a smaller rounding error.
    center: f64,
    squares: f64,
}

impl Moments {
    pub(super) fn add(&mut self, value: f64) {
        if value.is_nan() {
            return;
        }
        self.count += 1;
        self.sum += value;
        let deviation = value - self.center;
        self.center += deviation / self.count as f64;
        self.squares += deviation * (value - self.center);
    }

    pub(super) fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut moments = Self::default();
        values.for_each(|value| moments.add(value));
        moments
    }

    pub(super) fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    /// The standard deviation; NaN for fewer than two values.
    fn deviation(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { (self.squares / (self.count - 1) as f64).sqrt() }
    }
}

/// The 97.5 % points of Student's t, one per number of values, cached because each costs an iteration.
#[derive(Default)]
pub(super) struct Quantiles(RefCell<BTreeMap<usize, f64>>);

impl Quantiles {
    fn of(&self, count: usize) -> f64 {
        let quantile = || student(count).map_or(f64::NAN, |student| student.inverse_cdf(0.975));
        *self.0.borrow_mut().entry(count).or_insert_with(quantile)
    }

    /// The mean of values with its interval.
    pub(super) fn estimate(&self, values: &Moments) -> Estimate {
        let (count, mean) = (values.count, values.mean());
        let half_width = self.of(count) * values.deviation() / (count as f64).sqrt();
        Estimate { count, mean, low: mean - half_width, high: mean + half_width }
    }

    /// Tests whether the mean of the `differences` within pairs is zero.
    pub(super) fn paired_test(&self, differences: impl Iterator<Item = f64>) -> PairedTest {
        let moments = Moments::of(differences);
        let (difference, deviation) = (self.estimate(&moments), moments.deviation());
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

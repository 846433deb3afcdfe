use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How often each value from 0 to `MAX` occurred, for quantiles in bounded memory. Values are rounded to `1 / STEPS`.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(super) struct Counts<const STEPS: u32, const MAX: u32>(BTreeMap<u64, usize>);

impl<const STEPS: u32, const MAX: u32> Counts<STEPS, MAX> {
    /// Adds a value; a value beyond a limit counts as the limit.
    pub(super) fn add(&mut self, value: f64) {
        let value = value.clamp(0.0, f64::from(MAX));
        *self.0.entry((value * f64::from(STEPS)).round() as u64).or_default() += 1;
    }

    /// The number of values.
    pub(super) fn count(&self) -> usize {
        self.0.values().sum()
    }

    /// The value that this share of the values does not exceed; `None` without a value.
    pub(super) fn quantile(&self, share: f64) -> Option<f64> {
        self.quantile_with(0, share)
    }

    /// The same for these values and `infinite` others that are larger than all of them; `None` if it is one of the others.
    pub(super) fn quantile_with(&self, infinite: usize, share: f64) -> Option<f64> {
        let rank = rank(share, self.count() + infinite);
        let mut up_to = 0;
        let reaches_rank = |&(_, count): &(_, &usize)| {
            up_to += count;
            up_to > rank
        };
        self.0.iter().find(reaches_rank).map(|(&value, _)| value as f64 / f64::from(STEPS))
    }
}

#[cfg(test)]
impl<const STEPS: u32, const MAX: u32> Counts<STEPS, MAX> {
    /// The number of different values.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }
}

/// A running mean.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Mean {
    sum: f64,
    pub(super) count: usize,
}

impl Mean {
    pub(crate) fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    pub(super) fn add_bool(&mut self, is_true: bool) {
        self.add(f64::from(u8::from(is_true)));
    }

    /// Adds the mean of another `Mean` as one value; adds nothing if the other has no values.
    pub(super) fn add_mean(&mut self, other: &Self) {
        if let Some(mean) = other.get() {
            self.add(mean);
        }
    }

    /// The mean; `None` without values.
    pub(crate) fn get(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / self.count as f64)
    }
}

/// The value that a share of the values does not exceed: the smallest value that at least this share does not exceed. `None`
/// without a value.
pub fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(rank(share, sorted.len())).copied()
}

/// The position of this value among the sorted values, from 0 on.
pub(super) fn rank(share: f64, count: usize) -> usize {
    ((share * count as f64).ceil() as usize).max(1) - 1
}

/// The number of classes of equal width in the expected calibration error.
const CLASSES: usize = 10;

/// How well predicted probabilities of "blocked" were, as sums over predictions; every score is `None` without a prediction.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct ProbabilityScores {
    count: usize,
    squares: f64,
    /// For each class of predictions, the predicted minus the true number of blocked cells.
    excess: [f64; CLASSES],
}

impl ProbabilityScores {
    /// Adds a prediction.
    pub fn add(&mut self, predicted: f64, is_blocked: bool) {
        let truth = f64::from(u8::from(is_blocked));
        self.count += 1;
        self.squares += (predicted - truth) * (predicted - truth);
        self.excess[((predicted * CLASSES as f64) as usize).min(CLASSES - 1)] += predicted - truth;
    }

    /// Adds the scores of other predictions.
    pub fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.squares += other.squares;
        self.excess.iter_mut().zip(other.excess).for_each(|(excess, other)| *excess += other);
    }

    /// The Brier score: the mean of (prediction − truth)².
    pub fn brier(&self) -> Option<f64> {
        self.mean(self.squares)
    }

    /// The expected calibration error: the mean distance of the predicted from the true share in ten classes of predictions,
    /// by the number of predictions in each.
    pub fn calibration_error(&self) -> Option<f64> {
        self.mean(self.excess.iter().map(|excess| excess.abs()).sum())
    }

    fn mean(&self, sum: f64) -> Option<f64> {
        (self.count > 0).then(|| sum / self.count as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantile_is_the_smallest_value_that_the_share_does_not_exceed() {
        assert_eq!(quantile(&[], 0.5), None);
        for count in 1..60_u32 {
            let values: Vec<f64> = (0..count).map(|number| f64::from(number * 7 % 11)).collect();
            for percent in [0, 1, 5, 50, 90, 95, 99, 100] {
                let found = quantile(&values, f64::from(percent) / 100.0).unwrap();
                let up_to = |limit: f64| values.iter().filter(|value| **value <= limit).count() as u32;
                let is_enough = |limit: f64| 100 * up_to(limit) >= percent * count;
                let smallest = values.iter().copied().filter(|value| is_enough(*value)).reduce(f64::min);
                assert_eq!(Some(found), smallest, "{percent} % of {values:?}");
            }
        }
    }
}

#[cfg(test)]
mod probability_tests {
    use super::*;

    #[test]
    fn scores_of_four_predictions() {
        let (mut scores, mut more) = (ProbabilityScores::default(), ProbabilityScores::default());
        assert_eq!(scores.brier(), None);
        scores.add(0.12, false);
        scores.add(0.18, true);
        more.add(0.5, true);
        more.add(0.0, true);
        scores.merge(&more);
        let squares: f64 = 0.12 * 0.12 + 0.82 * 0.82 + 0.25 + 1.0;
        assert!((scores.brier().unwrap() - squares / 4.0).abs() < 1e-12);
        // The classes from 0 and from 0.1 on are apart.
        assert!((scores.calibration_error().unwrap() - (1.0 + 0.7 + 0.5) / 4.0).abs() < 1e-12);
    }
}

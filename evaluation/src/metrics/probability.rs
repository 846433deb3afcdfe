use serde::{Deserialize, Serialize};

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

    /// The number of predictions.
    pub fn count(&self) -> usize {
        self.count
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
    fn scores_of_four_predictions() {
        let (mut scores, mut more) = (ProbabilityScores::default(), ProbabilityScores::default());
        assert_eq!(scores.brier(), None);
        scores.add(0.12, false);
        scores.add(0.18, true);
        more.add(0.5, true);
        more.add(0.0, true);
        scores.merge(&more);
        let squares: f64 = 0.12 * 0.12 + 0.82 * 0.82 + 0.25 + 1.0;
        assert_eq!(scores.count(), 4);
        assert!((scores.brier().unwrap() - squares / 4.0).abs() < 1e-12);
        // The classes from 0 and from 0.1 on are apart.
        assert!((scores.calibration_error().unwrap() - (1.0 + 0.7 + 0.5) / 4.0).abs() < 1e-12);
    }
}

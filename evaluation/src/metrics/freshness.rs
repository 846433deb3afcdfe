//! How fresh a predicted map is: its Brier score over all things that change at all times, in view or not, and how long
//! lasting changes stay unknown.

use super::statistics::{Mean, quantile};
use serde::Serialize;

/// A change lasts if the thing then stays for this long, s.
const LASTING_S: f64 = 3600.0;

/// Scores the predicted states of things step by step.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub struct Freshness {
    step_s: f64,
    squares: Mean,
    steps: usize,
    stays: Vec<Option<Stay>>,
    /// Delay and whether it was detected, of each lasting change, s.
    changes: Vec<(f64, bool)>,
}

/// The state of a thing since it last changed.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
struct Stay {
    is_blocked: bool,
    /// The step of the change; `None` where the beginning was not seen.
    begin: Option<usize>,
    /// The step at which the prediction first was on the right side of ½.
    detected: Option<usize>,
}

/// How fresh a predicted map was.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FreshnessScores {
    /// The mean of (probability of being blocked − true state)² over all things and steps; NaN without any.
    pub brier: f64,
    /// The number of changes that lasted an hour or more.
    pub lasting_changes: usize,
    /// The median and the 95 % point of the time from such a change until the prediction is on the right side of ½, s. A
    /// look is not needed where the schedule is known. A missed change counts with the length of its stay. NaN without a
    /// change.
    pub detection_delay_s: [f64; 2],
    /// The share of such changes that was not known until the thing changed again, or the end; NaN without a change.
    pub missed: f64,
}

impl Freshness {
    /// Scores of steps of this duration, s.
    pub fn new(step_s: f64) -> Self {
        let (stays, changes) = (Vec::new(), Vec::new());
        Self { step_s, squares: Mean::default(), steps: 0, stays, changes }
    }

    /// The number of things.
    pub fn things(&self) -> usize {
        self.stays.len()
    }

    /// A step: the predicted probability of being blocked and the true state of every thing, in the same order at every step.
    pub fn add(&mut self, predicted: &[f64], is_blocked: &[bool]) {
        self.stays.resize(is_blocked.len(), None);
        for (thing, (predicted, is_blocked)) in predicted.iter().zip(is_blocked).enumerate() {
            let error = predicted - f64::from(u8::from(*is_blocked));
            self.squares.add(error * error);
            if let Some(stay) = self.stays[thing].filter(|stay| stay.is_blocked != *is_blocked) {
                self.end(stay);
                let stay = Stay { is_blocked: *is_blocked, begin: Some(self.steps), detected: None };
                self.stays[thing] = Some(stay);
            }
            let unknown = Stay { is_blocked: *is_blocked, begin: None, detected: None };
            let stay = self.stays[thing].get_or_insert(unknown);
            if stay.detected.is_none() && error.abs() < 0.5 {
                stay.detected = Some(self.steps);
            }
        }
        self.steps += 1;
    }

    /// The scores of all steps.
    pub fn scores(&self) -> FreshnessScores {
        let mut all = self.clone();
        self.stays.iter().flatten().for_each(|stay| all.end(*stay));
        let delays: Vec<f64> = all.changes.iter().map(|change| change.0).collect();
        let missed = all.changes.iter().filter(|change| !change.1).count();
        FreshnessScores {
            brier: self.squares.get().unwrap_or(f64::NAN),
            lasting_changes: delays.len(),
            detection_delay_s: [0.5, 0.95].map(|share| quantile(&delays, share).unwrap_or(f64::NAN)),
            missed: missed as f64 / delays.len() as f64,
        }
    }

    /// A stay ends at the current step.
    fn end(&mut self, stay: Stay) {
        let Some(begin) = stay.begin else { return };
        let seconds = |end: usize| (end - begin) as f64 * self.step_s;
        if seconds(self.steps) >= LASTING_S {
            let delay_s = seconds(stay.detected.unwrap_or(self.steps));
            self.changes.push((delay_s, stay.detected.is_some()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_of_two_things_by_hand() {
        // Steps of ten minutes. The first thing changes after 2 steps (known 3 steps later) and after 9 (stays 3: no hour);
        // the second one after 1 step, for 6 steps, and nobody knows; its last stay is known from its beginning on.
        let first = [0, 0, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 1];
        let second = [0, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0];
        let mut freshness = Freshness::new(600.0);
        for step in 0..13 {
            let predicted = [if (5..9).contains(&step) { 0.9 } else { 0.2 }, 0.4];
            freshness.add(&predicted, &[first[step] == 1, second[step] == 1]);
        }
        let scores = freshness.scores();
        let squares = 2.0 * 0.04 + 3.0 * 0.64 + 4.0 * 0.01 + 3.0 * 0.04 + 0.64 + 7.0 * 0.16 + 6.0 * 0.36;
        assert!((scores.brier - squares / 26.0).abs() < 1e-12);
        // Delays: 1800 s, 3600 s (missed), 0 s.
        assert_eq!(scores.lasting_changes, 3);
        assert_eq!(scores.detection_delay_s, [1800.0, 3600.0]);
        assert!((scores.missed - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn nothing_has_no_score() {
        let scores = Freshness::new(1.0).scores();
        assert!(scores.brier.is_nan() && scores.missed.is_nan() && scores.detection_delay_s[0].is_nan());
    }
}

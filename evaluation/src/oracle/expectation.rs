//! The expected effect of an observation on the log error of a cell.

use crate::metrics::log_error;

/// The tail of a Poisson distribution that is left out.
const TAIL: f64 = 1e-6;

/// The knowledge of the cycle rate of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knowledge {
    /// The true cycle rate, per unit of time; above 0.
    pub(super) truth: f64,
    /// The estimated cycle rate; 0 without an estimate.
    pub(super) estimate: f64,
    /// The number of events, of both kinds, from which the estimate is computed.
    pub(super) events: f64,
    /// The time for which the cell was in view.
    pub(super) watched: f64,
}

impl Knowledge {
    /// The log error now.
    pub(super) fn error(&self) -> f64 {
        log_error(self.estimate, self.truth)
    }

    /// The expected decrease of the log error if the cell is in view for `duration` more. Negative if the estimate
    /// happens to be correct.
    ///
    /// A cell with rate λ has a Poisson number of events with mean 2 λ · duration, and the new estimate is half of
    /// all events per time in view. The time in view so far is chosen so that it gives the present estimate,
    /// whatever the estimator.
    pub(super) fn expected_fall(&self, duration: f64) -> f64 {
        let (events, watched) = if self.estimate > 0.0 {
            let events = self.events.max(1.0);
            (events, events / (2.0 * self.estimate))
        } else {
            (0.0, self.watched)
        };
        let mean = 2.0 * self.truth * duration;
        let mut probability = libm::exp(-mean);
        let (mut left, mut count, mut expected) = (1.0, 0.0, 0.0);
        // The first probabilities of a large mean underflow: the sum must not end before the mean.
        while (left > TAIL || count < mean) && count < 2.0 * mean + 100.0 {
            let estimate = (events + count) / (2.0 * (watched + duration));
            expected += probability * log_error(estimate, self.truth);
            left -= probability;
            count += 1.0;
            probability *= mean / count;
        }
        self.error() - expected
    }
}

/// The time in view that tells as much about a cell as a look after a gap does: both have the same Fisher information
/// about the logarithm of the rate. `truth` is the cycle rate of the cell, and above 0.
///
/// A cell that leaves both of its states at the rate α = 2 · `truth` has another state after the gap with the probability
/// p = (1 − exp(−x)) / 2, x = 2 α · gap. Its information is (dp / d ln α)² / (p (1 − p)) = x² / (exp(2 x) − 1); that of a
/// time t in view is α t.
pub(super) fn gap_worth(gap: f64, truth: f64) -> f64 {
    let leave = 2.0 * truth;
    let x = 2.0 * leave * gap;
    if x > 0.0 { x * x / libm::expm1(2.0 * x) / leave } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    fn uniform(rng: &mut ChaCha8Rng) -> f64 {
        rng.next_u64() as f64 / u64::MAX as f64
    }

    /// The number of events of a Poisson process of `rate` in `duration`, by the times between them.
    fn events(rate: f64, duration: f64, rng: &mut ChaCha8Rng) -> f64 {
        let (mut time, mut count) = (0.0, -1.0);
        while time < duration {
            time -= libm::log(1.0 - uniform(rng)) / rate;
            count += 1.0;
        }
        count
    }

    #[test]
    fn the_expected_fall_is_the_mean_of_what_happens() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let known = |truth, estimate, events, watched| Knowledge { truth, estimate, events, watched };
        let cells = [known(0.1, 0.0, 0.0, 5.0), known(0.02, 0.05, 3.0, 30.0), known(0.4, 0.1, 60.0, 300.0)];
        for cell in cells {
            for duration in [1.0, 16.0, 64.0] {
                let watched =
                    if cell.estimate > 0.0 { cell.events / (2.0 * cell.estimate) } else { cell.watched };
                let (mut sum, mut squares, draws) = (0.0, 0.0, 20_000);
                for _ in 0..draws {
                    let count = cell.events + events(2.0 * cell.truth, duration, &mut rng);
                    let fall = cell.error() - log_error(count / (2.0 * (watched + duration)), cell.truth);
                    sum += fall;
                    squares += fall * fall;
                }
                let mean = sum / f64::from(draws);
                let sigma = ((squares / f64::from(draws) - mean * mean) / f64::from(draws)).sqrt();
                let expected = cell.expected_fall(duration);
                assert!(
                    (expected - mean).abs() < 4.0 * sigma + 1e-4,
                    "{cell:?} {duration}: {expected} {mean}"
                );
            }
        }
    }

    #[test]
    fn a_longer_stay_promises_more_for_a_cell_that_was_never_seen_to_change() {
        let cell = Knowledge { truth: 0.1, estimate: 0.0, events: 0.0, watched: 0.0 };
        let falls = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0].map(|stay| cell.expected_fall(stay));
        assert!(falls.is_sorted() && falls[0] > 0.0 && falls[6] < cell.error(), "{falls:?}");
    }

    #[test]
    fn a_correct_estimate_is_expected_to_get_worse() {
        let cell = Knowledge { truth: 0.1, estimate: 0.1, events: 4.0, watched: 20.0 };
        assert_eq!(cell.error(), 0.0);
        assert!(cell.expected_fall(8.0) < 0.0);
    }

    #[test]
    fn a_gap_is_worth_its_time_if_it_is_short_and_nothing_if_it_is_long() {
        let rate = 0.01;
        assert!((gap_worth(0.1, rate) - 0.1).abs() < 1e-3);
        assert!(gap_worth(1e4, rate) < 1e-9 && gap_worth(0.0, rate) == 0.0 && gap_worth(1e100, rate) == 0.0);
        // By differences of the probability that the state is another one.
        let changed = |leave: f64, gap: f64| (1.0 - libm::exp(-2.0 * leave * gap)) / 2.0;
        for gap in [5.0, 20.0, 60.0] {
            let (leave, step) = (2.0 * rate, 1e-5);
            let p = changed(leave, gap);
            let slope = (changed(leave * libm::exp(step), gap) - p) / step;
            let information = slope * slope / (p * (1.0 - p));
            assert!((gap_worth(gap, rate) * leave - information).abs() < 1e-4 * information, "{gap}");
        }
    }

    #[test]
    fn extremes_give_numbers() {
        for truth in [1e-300, 1e-9, 0.5, 1.0] {
            for estimate in [0.0, 1e-300, 0.5, 1e300] {
                for events in [0.0, 1.0, 1e9] {
                    let cell = Knowledge { truth, estimate, events, watched: 0.0 };
                    for duration in [0.0, 1.0, 64.0] {
                        assert!(cell.expected_fall(duration).is_finite(), "{cell:?} {duration}");
                    }
                }
            }
        }
    }
}

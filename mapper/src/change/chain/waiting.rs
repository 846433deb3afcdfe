//! Wait or go round: how long a state still lasts, and what waiting for its end costs against a detour.

use super::kernel::probability_of;
use super::{Posterior, STAYS, chains, leaving_rates};
use std::iter::zip;

/// The longest patience, s, if it has an end.
const LONGEST_S: f64 = 1e8;

/// How long a state still lasts: a mixture of exponential distributions, one for each rate that the chain may have. Where the rate
/// is uncertain, the hazard falls while the state lasts, so that patience has an end.
#[derive(Clone, Debug, PartialEq)]
pub struct Waiting {
    /// The rate at which the state ends, 1/s, and its probability.
    rates: Vec<[f64; 2]>,
}

impl Posterior {
    /// How long the thing is still there (or still away, by `is_there`), if it is so this time after a look, s. When that state began is
    /// not known: a look that finds it says that it lasts rather longer.
    pub fn waiting(&self, is_there: bool, was_there: bool, elapsed_s: f64) -> Waiting {
        let mut rates = leaving_rates().map(|rate| [rate, 0.0]);
        for (number, (weight, chain)) in zip(&self.chains, chains()).enumerate() {
            let stay = if is_there { number % STAYS } else { number / STAYS };
            if *weight > 0.0 {
                // What has just been seen otherwise needs some time to change.
                let found = probability_of(chain, was_there, is_there, elapsed_s.max(1e-3));
                rates[stay][1] += f64::from(*weight) * found;
            }
        }
        let sum: f64 = rates.iter().map(|[_, weight]| weight).sum();
        let found = rates.into_iter().filter(|[_, weight]| *weight > 0.0);
        Waiting { rates: found.map(|[rate, weight]| [rate, weight / sum]).collect() }
    }
}

impl Waiting {
    /// Of a state that ends at this rate, 1/s, above 0.
    pub fn known(rate_hz: f64) -> Self {
        Self { rates: vec![[rate_hz, 1.0]] }
    }

    /// The sum over all rates.
    fn sum(&self, of: impl Fn(f64) -> f64) -> f64 {
        self.rates.iter().map(|[rate, weight]| weight * of(*rate)).sum()
    }

    /// The probability that the state lasts longer than this, s.
    pub fn lasts(&self, time_s: f64) -> f64 {
        self.sum(|rate| libm::exp(-rate * time_s))
    }

    /// The expected time until the way is free, s, if the robot waits for at most `patience_s` and then takes the detour, which takes
    /// `detour_s` longer than the way itself.
    pub fn cost_s(&self, patience_s: f64, detour_s: f64) -> f64 {
        let waited_s = self.sum(|rate| -libm::expm1(-rate * patience_s) / rate);
        let in_vain = self.lasts(patience_s);
        if in_vain > 0.0 { waited_s + in_vain * detour_s } else { waited_s }
    }

    /// The best patience against a detour that takes this much longer than the way itself, s; infinite where there is none. It ends when
    /// the hazard, which falls, has come down to one per detour.
    pub fn patience_s(&self, detour_s: f64) -> f64 {
        if self.rates.iter().all(|[rate, _]| rate * detour_s > 1.0) {
            return f64::INFINITY;
        }
        let is_worth =
            |time_s: f64| self.sum(|rate| (rate * detour_s - 1.0) * libm::exp(-rate * time_s)) > 0.0;
        let (mut low_s, mut high_s) = (0.0, if is_worth(0.0) { LONGEST_S } else { 0.0 });
        for _ in 0..60 {
            let middle_s = 0.5 * (low_s + high_s);
            *if is_worth(middle_s) { &mut low_s } else { &mut high_s } = middle_s;
        }
        low_s
    }

    /// The expected time until the way is free with the best patience, s: see [`cost_s`](Self::cost_s).
    pub fn best_s(&self, detour_s: f64) -> f64 {
        self.cost_s(self.patience_s(detour_s), detour_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::change::{Evidence, Population};
    use proptest::prelude::*;

    /// A thing that was seen to stay for these times, s, some of them to the end, and to be away for a minute between them.
    fn posterior(stays_s: &[(f64, bool)]) -> Posterior {
        let mut evidence = Evidence::default();
        for (stay_s, is_over) in stays_s {
            evidence.gap(false, true, 60.0);
            (0..(stay_s / 2.0) as u32).for_each(|_| evidence.look(true, true, 2.0));
            match is_over {
                true => evidence.look(true, false, 0.5),
                false => evidence.gap(true, false, 3600.0),
            }
        }
        Posterior::new(&evidence, &Population::default())
    }

    proptest! {
        /// The chosen patience is as good as the best one of many, and its cost is that of its definition, by simulation in small steps.
        #[test]
        fn the_patience_is_the_best_one(
            stays_s in prop::collection::vec((2.0..600.0, any::<bool>()), 0..8),
            detour_s in 1.0..2000.0,
            was_there: bool,
            elapsed_s in 0.0..5000.0,
        ) {
            let waiting = posterior(&stays_s).waiting(true, was_there, elapsed_s);
            let (patience_s, cost_s) = (waiting.patience_s(detour_s), waiting.best_s(detour_s));
            prop_assert!((waiting.lasts(0.0) - 1.0).abs() < 1e-6);
            let tries = (0..400).map(|step| libm::pow(1.05, f64::from(step)) - 1.0).chain([f64::INFINITY]);
            for other_s in tries {
                let other = waiting.cost_s(other_s, detour_s);
                prop_assert!(cost_s <= other + 1e-6 * other, "{patience_s}: {cost_s}, {other_s}: {other}");
            }
            let step_s = 0.05;
            let short_s = patience_s.min(200.0);
            let steps = (short_s / step_s) as u32;
            let summed: f64 = (0..steps).map(|step| step_s * waiting.lasts(step_s * (f64::from(step) + 0.5))).sum();
            let by_sum = summed + waiting.lasts(short_s) * detour_s;
            prop_assert!((waiting.cost_s(short_s, detour_s) - by_sum).abs() < 0.1, "{by_sum}");
        }

        /// With a known rate there is nothing to learn from a wait: it is worth it from the begin to the end, or not at all.
        #[test]
        fn a_known_rate_waits_to_the_end_or_not_at_all(stay_s in 1.0..10_000.0, detour_s in 1.0..10_000.0) {
            let waiting = Waiting::known(1.0 / stay_s);
            prop_assert_eq!(waiting.patience_s(detour_s), if stay_s < detour_s { f64::INFINITY } else { 0.0 });
            prop_assert!((waiting.best_s(detour_s) - f64::min(stay_s, detour_s)).abs() < 1e-9 * detour_s);
        }
    }

    /// A wait without an end is evidence: what was expected of a longer wait before it is what is expected after it.
    #[test]
    fn a_censored_wait_is_evidence() {
        let mut evidence = Evidence::default();
        evidence.gap(false, true, 60.0);
        let before = Posterior::new(&evidence, &Population::default()).waiting(true, true, 0.0);
        (0..30).for_each(|_| evidence.look(true, true, 2.0));
        let after = Posterior::new(&evidence, &Population::default()).waiting(true, true, 0.0);
        for time_s in [10.0, 100.0, 1000.0, 1e5] {
            let expected = before.lasts(60.0 + time_s) / before.lasts(60.0);
            assert!((after.lasts(time_s) - expected).abs() < 1e-3, "{time_s}");
        }
        assert!(after.patience_s(120.0) < before.patience_s(120.0));
    }

    /// A stay that a look finds under way is longer than others, since the longer it is, the more probably a look finds it.
    #[test]
    fn a_stay_that_is_found_under_way_is_rather_a_long_one() {
        let posterior = posterior(&[(20.0, true), (400.0, false)]);
        let [come, found] = [0.0, 1e6].map(|elapsed_s| posterior.waiting(true, false, elapsed_s).lasts(60.0));
        assert!(come + 0.02 < found, "{come}, {found}");
        let [came, away] = [true, false].map(|is_there| posterior.waiting(is_there, is_there, 0.0));
        assert_ne!(came, away);
    }

    #[test]
    fn without_a_way_round_it_waits() {
        let waiting = posterior(&[(20.0, true)]).waiting(true, true, 5.0);
        assert!(
            waiting.patience_s(f64::INFINITY) == f64::INFINITY && waiting.best_s(f64::INFINITY).is_finite()
        );
        assert_eq!([waiting.patience_s(0.0), waiting.best_s(0.0)], [0.0; 2]);
    }
}

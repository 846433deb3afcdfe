use super::gamma::quantile;
use crate::change::{Belief, RateDistribution};

/// Minimum of a probability or an information: the product of two of them is still above 0.
const MIN_VALUE: f64 = 1e-150;

/// The variance of the number of passages divided by their mean: people go somewhere and come back, so that passages come in
/// pairs. Chosen on generated houses (seeds 3000 to 3007): 88 % of the true rates are then in the 90 % interval, and 83 % with 1.
const DISPERSION: f64 = 2.0;

/// The interval that contains a gamma distributed rate with the probability `mass`, with equal probabilities below and above.
fn interval(rate: f64, shape: f64, mass: f64) -> (f64, f64) {
    let mass = mass.clamp(0.0, 1.0);
    let [low, high] = [0.5 - 0.5 * mass, 0.5 + 0.5 * mass].map(|end| rate * quantile(shape, end));
    (low, high)
}

impl Belief {
    /// The interval of the cycle rate by the posterior of the two-state chain in steps of `period`. Assumes that the
    /// rate is gamma distributed, which is true if only one of the two probabilities is uncertain.
    pub(super) fn interval(self, period: f64, mass: f64) -> (f64, f64) {
        let Self { exposure: all, mixed } = self;
        let [block, free] = all.leave().map(|leave| leave.clamp(MIN_VALUE, 1.0));
        let information = [(0, block), (1, free)]
            .map(|(state, leave)| (all.steps[state] * leave * (1.0 - leave)).max(MIN_VALUE));
        let most = 0.999 * libm::sqrt(information[0] * information[1]);
        let mixed = mixed.clamp(-most, most);
        let determinant = information[0] * information[1] - mixed * mixed;
        // ln r = −ln(1/a + 1/b) grows with the log-odds of a by the share of the cycle that is free, times
        // (1 − a), and likewise with those of b.
        let slopes = [free / (block + free) * (1.0 - block), block / (block + free) * (1.0 - free)];
        let variance = (slopes[0] * slopes[0] * information[1] - 2.0 * slopes[0] * slopes[1] * mixed
            + slopes[1] * slopes[1] * information[0])
            / determinant;
        let rate = block * free / (block + free) / period;
        // Limits between certain knowledge and no knowledge.
        let shape = (1.0 / variance).clamp(0.05, 1e12);
        let (low, high) = interval(rate, shape, mass);
        (low.min(0.5 / period), high.min(0.5 / period))
    }
}

impl RateDistribution {
    /// The interval that contains the rate with the probability `mass`, if events come in pairs: people go somewhere and come
    /// back.
    pub fn interval(self, mass: f64) -> (f64, f64) {
        interval(self.mean().min(f64::MAX), self.events / DISPERSION, mass)
    }
}

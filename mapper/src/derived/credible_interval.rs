use super::gamma;
use crate::change::Belief;

/// The interval that contains the cycle rate with probability `mass`, with equal probabilities below and above the
/// interval, by the posterior of the two-state chain in steps of `period`. Assumes that the rate is gamma
/// distributed, which is true if only one of the two probabilities is uncertain.
pub(super) fn of_cycle_rate(Belief { exposure: all, mixed }: Belief, period: f64, mass: f64) -> (f64, f64) {
    let [block, free] = all.leave().map(|leave| leave.clamp(f64::MIN_POSITIVE, 1.0));
    let information = [(0, block), (1, free)]
        .map(|(state, leave)| (all.steps[state] * leave * (1.0 - leave)).max(f64::MIN_POSITIVE));
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
    let mass = mass.clamp(0.0, 1.0);
    let quantile = |probability: f64| (rate * gamma::quantile(shape, probability)).min(0.5 / period);
    (quantile(0.5 - 0.5 * mass), quantile(0.5 + 0.5 * mass))
}

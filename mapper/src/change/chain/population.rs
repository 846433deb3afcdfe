use super::{Chains, RATIO, STAYS, leaving_rates};
use std::iter::zip;

/// The number of things that the shipped population counts as.
const SHIPPED_THINGS: f64 = 8.0;
/// In the shipped population, the logarithm of a mean stay is uniform from 10 s to 12 h, and falls off as a normal distribution
/// with this standard deviation on both sides.
const USUAL_S: [f64; 2] = [10.0, 43_200.0];
const FALL: f64 = 1.0;
/// The standard deviation by which what is known of a thing is smoothed, in the logarithm of a mean stay: the next thing is like it,
/// not the same.
const SMOOTHING: f64 = 0.7;

/// How probable each chain is for a thing of which nothing was seen.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Population {
    /// Their sum is 1.
    pub(super) chains: Chains,
}

impl Default for Population {
    /// The shipped population.
    fn default() -> Self {
        let [low, high] = USUAL_S.map(libm::log);
        let of_stay = leaving_rates().map(|rate| {
            let log = -libm::log(rate);
            let far = ((low - log).max(log - high).max(0.0)) / FALL;
            libm::exp(-0.5 * far * far)
        });
        Self::normalized(of_stay.iter().flat_map(|away| of_stay.map(|there| away * there)).collect())
    }
}

impl Population {
    /// The shipped population.
    pub(crate) fn shipped() -> &'static Self {
        static SHIPPED: std::sync::LazyLock<Population> = std::sync::LazyLock::new(Population::default);
        &SHIPPED
    }

    /// The population of things whose probabilities of each chain have this sum.
    pub(super) fn of_sum(sum: &Chains) -> Self {
        let shipped = Self::default().chains.into_iter();
        let all = zip(shipped, smoothed(sum)).map(|(shipped, things)| SHIPPED_THINGS * shipped + things);
        Self::normalized(all.collect())
    }

    fn normalized(mut chains: Chains) -> Self {
        let sum: f64 = chains.iter().sum();
        chains.iter_mut().for_each(|chain| *chain /= sum);
        Self { chains }
    }
}

/// Smooths along both axes. What would leave the grid stays in it.
fn smoothed(chains: &Chains) -> Chains {
    let step = libm::log(RATIO) / SMOOTHING;
    let weight = |apart: usize| libm::exp(-0.5 * (apart as f64 * step) * (apart as f64 * step));
    let weights: [f64; STAYS] = std::array::from_fn(weight);
    let sums: [f64; STAYS] =
        std::array::from_fn(|from| (0..STAYS).map(|to| weights[to.abs_diff(from)]).sum());
    // Along one axis, with the axes exchanged in the result.
    let along = |chains: &Chains| -> Chains {
        let cell = |number: usize| {
            let (to, other) = (number / STAYS, number % STAYS);
            (0..STAYS)
                .map(|from| chains[other * STAYS + from] * weights[to.abs_diff(from)] / sums[from])
                .sum()
        };
        (0..STAYS * STAYS).map(cell).collect()
    };
    along(&along(chains))
}

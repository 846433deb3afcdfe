use super::{Evidence, Population, RATIO, SHORTEST_S, STAYS, chains};
use std::iter::zip;

/// Rates are kept in bins of this width, in the logarithm, from the lowest one of the grid on; and their number.
const WIDTH: f64 = 0.1;
const BINS: usize = 160;

/// What is known of the chain of a thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Posterior {
    /// The probability of each chain; their sum is 1.
    pub(super) chains: Vec<f32>,
    /// For the chains whose rates have about the same sum: that sum, 1/s, their probability, and that times their share of the time
    /// there.
    fading: Vec<[f64; 3]>,
    /// The probability of each bin of the cycle rate.
    cycle_rates: Vec<f64>,
    mean_log_rate: f64,
}

impl Posterior {
    /// The posterior by evidence and population.
    pub fn new(evidence: &Evidence, population: &Population) -> Self {
        let mut weights = evidence.log_likelihood();
        let most = weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        zip(&mut weights, &population.chains)
            .for_each(|(weight, prior)| *weight = libm::exp(*weight - most) * prior);
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);

        let (mut fading, mut cycle_rates) = (vec![[0.0; 3]; BINS], vec![0.0; BINS]);
        let mut mean_log_rate = 0.0;
        let half_step = (libm::log(RATIO) / WIDTH / 2.0) as usize;
        for (weight, [come, go]) in zip(&weights, chains()).filter(|(weight, _)| **weight > 0.0) {
            let all = come + go;
            let log_rate = libm::log(come * go / all);
            mean_log_rate += weight * log_rate;
            let at = bin(libm::log(all));
            zip(&mut fading[at], [weight * all, *weight, weight * come / all])
                .for_each(|(sum, value)| *sum += value);
            // A chain stands for those up to half a step around it.
            let at = bin(log_rate);
            let spread = at.saturating_sub(half_step)..=(at + half_step).min(BINS - 1);
            let share = weight / spread.clone().count() as f64;
            cycle_rates[spread].iter_mut().for_each(|rate| *rate += share);
        }
        fading.retain(|[_, weight, _]| *weight > 1e-9);
        fading.iter_mut().for_each(|[all, weight, _]| *all /= *weight);
        let chains = weights.into_iter().map(|weight| weight as f32).collect();
        Self { chains, fading, cycle_rates, mean_log_rate }
    }

    /// The probability that the thing is there, this time after a look, s.
    pub fn probability(&self, was_there: bool, elapsed_s: f64) -> f64 {
        let was_there = f64::from(u8::from(was_there));
        self.fading
            .iter()
            .map(|[all, weight, there]| there + (was_there * weight - there) * libm::exp(-all * elapsed_s))
            .sum()
    }

    /// The cycle rate, 1/s: the median, about.
    pub fn cycle_rate(&self) -> f64 {
        libm::exp(self.mean_log_rate)
    }

    /// The interval that contains the cycle rate with this probability, 1/s.
    pub fn interval(&self, mass: f64) -> (f64, f64) {
        let end = |probability: f64| {
            let mut below = 0.0;
            for (bin, weight) in self.cycle_rates.iter().enumerate() {
                if below + weight >= probability && *weight > 0.0 {
                    let part = (probability - below) / weight;
                    return libm::exp(lowest() + (bin as f64 + part) * WIDTH);
                }
                below += weight;
            }
            libm::exp(lowest() + BINS as f64 * WIDTH)
        };
        (end(0.5 - 0.5 * mass), end(0.5 + 0.5 * mass))
    }
}

impl Population {
    /// The population to which these things belong.
    pub fn of<'a>(things: impl Iterator<Item = &'a Posterior>) -> Self {
        let mut sum = vec![0.0; STAYS * STAYS];
        for thing in things {
            zip(&mut sum, &thing.chains).for_each(|(sum, chain)| *sum += f64::from(*chain));
        }
        Self::of_sum(&sum)
    }
}

/// The lower end of the lowest bin: below the cycle rate of the slowest chain.
fn lowest() -> f64 {
    -libm::log(SHORTEST_S) - libm::log(RATIO) * STAYS as f64 - 1.0
}

fn bin(log_rate: f64) -> usize {
    (((log_rate - lowest()) / WIDTH) as usize).min(BINS - 1)
}

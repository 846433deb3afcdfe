use super::{Chains, Evidence, Population, RATIO, SHORTEST_S, STAYS, chains};
use std::iter::zip;
use std::ops::Range;
use std::sync::LazyLock;

/// Rates are kept in bins of this width, in the logarithm, from the lowest one of the grid on; and their number.
const WIDTH: f64 = 0.1;
const BINS: usize = 160;

/// The logarithm of what is as good as nothing beside the most probable chain.
const NOTHING: f64 = -40.0;

const HOUR_S: f64 = 3600.0;

/// What a posterior asks of a chain.
struct Chain {
    /// The sum of its rates, 1/s, its share of the time there, and the logarithm of its cycle rate.
    all: f64,
    share: f64,
    log_rate: f64,
    /// The bin of the sum of its rates, and those of its cycle rate: it stands for the chains up to half a step around it.
    fades: usize,
    spread: Range<usize>,
}

static CHAINS: LazyLock<Vec<Chain>> = LazyLock::new(|| {
    let half_step = (libm::log(RATIO) / WIDTH / 2.0) as usize;
    let of = |[come, go]: [f64; 2]| {
        let all = come + go;
        let log_rate = libm::log(come * go / all);
        let at = bin(log_rate);
        let spread = at.saturating_sub(half_step)..(at + half_step + 1).min(BINS);
        Chain { all, share: come / all, log_rate, fades: bin(libm::log(all)), spread }
    };
    chains().map(of).collect()
});

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
        let (mut weights, _) = weighed(evidence.log_likelihood(), population);
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);

        let (mut fading, mut cycle_rates) = (vec![[0.0; 3]; BINS], vec![0.0; BINS]);
        let mut mean_log_rate = 0.0;
        for (weight, chain) in zip(&weights, &*CHAINS).filter(|(weight, _)| **weight > 0.0) {
            mean_log_rate += weight * chain.log_rate;
            zip(&mut fading[chain.fades], [weight * chain.all, *weight, weight * chain.share])
                .for_each(|(sum, value)| *sum += value);
            let share = weight / chain.spread.len() as f64;
            cycle_rates[chain.spread.clone()].iter_mut().for_each(|rate| *rate += share);
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

    /// The share of the time that the thing is there, and the rate at which a look at it fades, 1/s: the sum of both rates.
    pub(crate) fn share_and_fading(&self) -> (f64, f64) {
        let sum = |of: fn(&[f64; 3]) -> f64| self.fading.iter().map(of).sum::<f64>();
        (sum(|[_, _, there]| *there), libm::exp(sum(|[all, weight, _]| weight * libm::log(*all))))
    }

    /// The cycle rate, 1/s: the median, about.
    pub fn cycle_rate(&self) -> f64 {
        libm::exp(self.mean_log_rate)
    }

    /// The cycles per hour, and the interval that contains them with a probability of 90 %.
    pub fn per_hour(&self) -> (f64, [f64; 2]) {
        let (low, high) = self.interval(0.9);
        (self.cycle_rate() * HOUR_S, [low, high].map(|rate| rate * HOUR_S))
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

impl Evidence {
    /// How much more probable than one chain it is that the rates of a thing have changed when `recent` began, which is a part of this
    /// evidence, in the logarithm.
    pub(crate) fn drift(&self, recent: &Self) -> f64 {
        let (all, recent) = (self.log_likelihood(), recent.log_likelihood());
        let before = zip(&all, &recent).map(|(all, recent)| all - recent).collect();
        let [all, before, recent] = [all, before, recent].map(log_evidence);
        before + recent - all
    }
}

/// The logarithm of the probability of what has this logarithm of a likelihood, in the shipped population.
fn log_evidence(log_likelihood: Chains) -> f64 {
    let (weights, most) = weighed(log_likelihood, Population::shipped());
    most + libm::log(weights.iter().sum())
}

/// The probability of each chain, by the logarithm of its likelihood, divided by a number, and the logarithm of this number.
fn weighed(mut chains: Chains, population: &Population) -> (Chains, f64) {
    let most = chains.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    for (chain, prior) in zip(&mut chains, &population.chains) {
        let apart = *chain - most;
        *chain = if apart > NOTHING { libm::exp(apart) * prior } else { 0.0 };
    }
    (chains, most)
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

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

/// The number of times at which what is left of a look is integrated, and the longest time, s: longer than any stay.
const TIMES: usize = 24;
const LONGEST_S: f64 = 1e7;

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

/// How looks at a thing fade. For the chains whose rates have about the same sum: that sum, 1/s, their probability, and that times
/// their share of the time there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fading(Vec<[f64; 3]>);

/// What is known of the chain of a thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Posterior {
    /// The probability of each chain; their sum is 1.
    pub(super) chains: Vec<f32>,
    fading: Fading,
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
        Self { chains, fading: Fading(fading), cycle_rates, mean_log_rate }
    }

    /// How looks fade.
    pub(crate) fn fading(&self) -> &Fading {
        &self.fading
    }

    /// The probability that the thing is there, this time after a look, s.
    pub fn probability(&self, was_there: bool, elapsed_s: f64) -> f64 {
        self.fading.probability(was_there, elapsed_s)
    }

    /// The share of the time that the thing is there, and the rate at which a look at it fades, 1/s: the sum of both rates.
    pub(crate) fn share_and_fading(&self) -> (f64, f64) {
        let rate = self.fading.sum(|[all, weight, _]| weight * libm::log(*all));
        (self.fading.share(), libm::exp(rate))
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

impl Fading {
    fn sum(&self, of: impl Fn(&[f64; 3]) -> f64) -> f64 {
        self.0.iter().map(of).sum()
    }

    /// The share of the time that the thing is there.
    pub(crate) fn share(&self) -> f64 {
        self.sum(|[_, _, there]| *there)
    }

    pub(super) fn probability(&self, was_there: bool, elapsed_s: f64) -> f64 {
        let was_there = f64::from(u8::from(was_there));
        self.sum(|[all, weight, there]| there + (was_there * weight - there) * libm::exp(-all * elapsed_s))
    }

    /// What a look at the thing is worth, this time after the last look, s: how much it takes away from the Brier score of the
    /// predicted state, integrated until the next look, which is expected to come as late as the last one was. A look takes away the
    /// variance p (1 − p) of the state, and comes back into it as ρ², the square of what is left of a look after a time.
    pub(crate) fn look_worth(&self, was_there: bool, elapsed_s: f64) -> f64 {
        let there = self.probability(was_there, elapsed_s);
        there * (1.0 - there) * self.remembered_s(elapsed_s)
    }

    /// ∫ρ² until a time, s: ρ is the mean of e^(−sτ) over the sums s of the rates.
    pub(crate) fn remembered_s(&self, until_s: f64) -> f64 {
        let until_s = until_s.min(LONGEST_S);
        let part = |number: usize| {
            // Denser at first, where ρ falls.
            let at = (number as f64 + 0.5) / TIMES as f64;
            let left = self.sum(|[all, weight, _]| weight * libm::exp(-all * until_s * at * at * at));
            3.0 * at * at * left * left
        };
        until_s / TIMES as f64 * (0..TIMES).map(part).sum::<f64>()
    }

    /// What is known if the thing stayed away in view for this time, s, and the probability of that.
    pub(crate) fn after_silence(&self, silent_s: f64) -> (Self, f64) {
        let stays = |[all, weight, there]: &[f64; 3]| libm::exp(-all * there / weight * silent_s);
        let silent = self.sum(|chains| chains[1] * stays(chains));
        let after = |chains: &[f64; 3]| {
            let [all, weight, there] = *chains;
            let more = stays(chains) / silent;
            [all, weight * more, there * more]
        };
        if silent > 1e-12 { (Self(self.0.iter().map(after).collect()), silent) } else { (self.clone(), 0.0) }
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

//! The expected decrease of the error of a cell's rate when the cell is observed.
//!
//! The error of an estimate r̂ of a rate r is |ln(r̂ / r)|, at most ln 10, and ln 10 without an estimate:
//! over- and underestimates weigh the same. Rates are cycles per unit of time: blocked, free and blocked
//! again. Events of a thing that moves by rule are more regular than those of a Poisson process. In an
//! uninterrupted watch of x cycles the variance of their number is x / (1 + x / φ): x, as for a Poisson process,
//! where x is small, and at most φ, since a regular thing is at most one event off at each end of the watch. An
//! uninterrupted watch therefore has more information than the same time in pieces.

use std::f64::consts::LN_10;

/// The durations of an observation that are considered, in the time unit of the readings.
pub(super) const WATCHES: [f64; 8] = [1.0, 4.0, 10.0, 20.0, 40.0, 80.0, 160.0, 320.0];
/// The expected gain of each of [`WATCHES`], in units of the error.
pub(super) type Gains = [f64; WATCHES.len()];

/// The number of discrete rates.
pub(super) const RATES: usize = 14;
/// The probability of each rate.
pub(super) type Distribution = [f64; RATES];
/// The highest rate, and the ratio of each rate to the one before: from 3 to 8000 units of time per cycle.
const FASTEST: f64 = 0.3;
const RATIO: f64 = 0.55;

/// φ: the maximum variance of the number of cycles in one uninterrupted observation.
const MOST_VARIANCE: f64 = 0.5;
/// The minimum variance that is assumed for the number of cycles in the present uninterrupted observation.
const LEAST_VARIANCE: f64 = 0.02;
/// The square of the mean deviation of a normal variable over its variance, 2 / π.
const MEAN_OF_NORMAL: f64 = std::f64::consts::FRAC_2_PI;
/// From this number of cycles on the rate counts as known; below this number, only the distribution of the rate is
/// known.
const KNOWN_CYCLES: f64 = 3.0;
/// The pseudocounts of a rate: half a cycle in ten units of time.
const PRIOR_CYCLES: f64 = 0.5;
const PRIOR_TIME: f64 = 10.0;
/// Bins of observation times have width 1 up to this number; then their widths grow by the factor [`BIN_RATIO`].
const FINE_BINS: usize = 16;
const BIN_RATIO: f64 = 1.15;
pub(super) const BINS: usize = 64;

/// What was observed of a cell that changed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watched {
    /// Half the number of events in view.
    pub(super) cycles: f64,
    /// The time in view.
    pub(super) time: f64,
    /// The rate by the estimator in use; 0 without an estimate.
    pub(super) estimate: f64,
    /// The time in view without interruption until now.
    pub(super) run: f64,
    /// The variance of the number of cycles in earlier uninterrupted observations.
    pub(super) past_variance: f64,
}

impl Watched {
    /// The rate with pseudocounts; above zero.
    pub(super) fn rate(&self) -> f64 {
        (self.cycles + PRIOR_CYCLES) / (self.time + PRIOR_TIME)
    }
}

/// The variance of the number of cycles in an uninterrupted observation of `cycles` cycles.
pub(super) fn variance(cycles: f64) -> f64 {
    cycles / (1.0 + cycles / MOST_VARIANCE)
}

/// The expectation for a cell that changed: the distribution of its rate, and the gains of a new observation and of
/// one that continues without a gap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expected {
    pub(super) distribution: Distribution,
    pub(super) anew: Gains,
    pub(super) continued: Gains,
}

/// Tables over discrete rates and observation times.
#[derive(Clone, Debug)]
pub(super) struct Rates {
    rates: Distribution,
    logs: Distribution,
    /// The probability of no event, for each observation time and each rate.
    silence: Vec<Distribution>,
    /// The gain of each duration for a cell without an event, at each rate.
    first: [Gains; RATES],
}

impl Rates {
    pub(super) fn new() -> Self {
        let rates: Distribution = std::array::from_fn(|rate| FASTEST * libm::pow(RATIO, rate as f64));
        let first = |rate: f64| WATCHES.map(|watch| LN_10 - error_after_first(rate, 0.0, watch));
        let time = |bin: usize| match bin.checked_sub(FINE_BINS) {
            Some(step) => FINE_BINS as f64 * libm::pow(BIN_RATIO, step as f64),
            None => bin as f64,
        };
        Self {
            logs: rates.map(libm::log),
            silence: (0..BINS).map(|bin| rates.map(|rate| libm::exp(-rate * time(bin)))).collect(),
            first: rates.map(first),
            rates,
        }
    }

    /// The bin of an observation time without an event.
    pub(super) fn bin(time: f64) -> usize {
        let fine = FINE_BINS as f64;
        if time < fine {
            return time.max(0.0) as usize;
        }
        let step = libm::log(time / fine) / libm::log(BIN_RATIO);
        ((fine + step.round()) as usize).min(BINS - 1)
    }

    /// For a cell that changes and whose rate has this distribution: the probability of no event in the observation
    /// time of the bin, and the gains of an observation of the cell, times that probability.
    pub(super) fn silent(&self, distribution: &Distribution, bin: usize) -> (f64, Gains) {
        let (mut silent, mut gains) = (0.0, Gains::default());
        for ((probability, silence), first) in distribution.iter().zip(&self.silence[bin]).zip(&self.first) {
            let probability = probability * silence;
            silent += probability;
            gains.iter_mut().zip(first).for_each(|(gain, first)| *gain += probability * first);
        }
        (silent, gains)
    }

    /// A distribution around a rate, on a logarithmic scale; each discrete rate is about twice the next.
    pub(super) fn around(&self, rate: f64) -> Distribution {
        const SPREAD: f64 = 0.6;
        let middle = libm::log(rate);
        let distance = |log: f64| ((log - middle) / SPREAD).clamp(-20.0, 20.0);
        normalised(self.logs.map(|log| libm::exp(-0.5 * distance(log) * distance(log))))
    }

    /// The expectation for a cell that changed. `prior` is the distribution of its rate before it was observed.
    pub(super) fn of_changed(&self, seen: &Watched, prior: &Distribution) -> Expected {
        if seen.cycles >= KNOWN_CYCLES && seen.estimate > 0.0 {
            self.of_known(seen)
        } else {
            self.of_uncertain(seen, prior)
        }
    }

    /// The error is √(2 V / π) / n for n cycles with variance V.
    fn of_known(&self, seen: &Watched) -> Expected {
        let rate = seen.rate();
        let spread = |variance: f64, cycles: f64| libm::sqrt(MEAN_OF_NORMAL * variance) / cycles;
        let so_far = seen.past_variance + variance(rate * seen.run).max(LEAST_VARIANCE);
        let now = spread(so_far, seen.cycles);
        let gain = |variance: f64, watch: f64| (now - spread(variance, seen.cycles + rate * watch)).max(0.0);
        Expected {
            distribution: self.nearest(rate),
            anew: WATCHES.map(|watch| gain(so_far + variance(rate * watch), watch)),
            continued: WATCHES.map(|watch| {
                gain(seen.past_variance + variance(rate * (seen.run + watch)).max(LEAST_VARIANCE), watch)
            }),
        }
    }

    /// The error is averaged over the rates that the cell may have. At each rate it consists of the bias of the
    /// estimate and of the scatter of the cycles to come.
    fn of_uncertain(&self, seen: &Watched, prior: &Distribution) -> Expected {
        let &Watched { cycles, time, estimate, run, past_variance } = seen;
        let mut distribution: Distribution = std::array::from_fn(|rate| {
            let expected = (self.rates[rate] * time).max(1e-9);
            cycles * libm::log(expected) - expected + libm::log(prior[rate].max(1e-300))
        });
        let top = distribution.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        distribution = normalised(distribution.map(|log| libm::exp(log - top)));
        // Half the scatter so far: the other half is that of the distribution.
        let half = 0.5 * (past_variance + variance(seen.rate() * run).max(LEAST_VARIANCE));
        let has_estimate = estimate > 0.0 && cycles > 0.0;
        let estimate_time = if has_estimate { cycles / estimate } else { time };
        let (mut anew, mut continued) = (Gains::default(), Gains::default());
        let likely = self.rates.into_iter().zip(distribution).filter(|(_, probability)| *probability > 1e-4);
        for (rate, probability) in likely {
            let error = |bias: f64, variance: f64, cycles: f64| {
                let squared = bias * bias + MEAN_OF_NORMAL * variance / (cycles * cycles);
                libm::sqrt(squared).min(LN_10)
            };
            let now =
                if has_estimate { error(libm::log(estimate / rate), half, cycles.max(0.5)) } else { LN_10 };
            for (index, watch) in WATCHES.into_iter().enumerate() {
                let (new, total) = (rate * watch, cycles + rate * watch);
                let (first, longer) = if has_estimate {
                    let bias = libm::log(total / (estimate_time + watch) / rate);
                    let rest = half * cycles / total;
                    let added = variance(rate * (run + watch)) - variance(rate * run);
                    (error(bias, variance(new) + rest, total), error(bias, added.max(0.0) + rest, total))
                } else {
                    let after = error_after_first(rate, estimate_time, watch);
                    (after, after)
                };
                anew[index] += probability * (now - first);
                continued[index] += probability * (now - longer);
            }
        }
        // The assumptions can make the present estimate seem better than the later one. An observation is never a
        // loss.
        Expected {
            distribution,
            anew: anew.map(|gain| gain.max(0.0)),
            continued: continued.map(|gain| gain.max(0.0)),
        }
    }

    fn nearest(&self, rate: f64) -> Distribution {
        let index = libm::log(rate / FASTEST) / libm::log(RATIO);
        let nearest = (index.round().max(0.0) as usize).min(RATES - 1);
        std::array::from_fn(|rate| if rate == nearest { 1.0 } else { 0.0 })
    }
}

/// The expected error of a cell without an event so far, after another observation of duration `watch`: ln 10 if
/// there is still no event (probability e^(−x) for x expected cycles), otherwise bias and scatter of the first few
/// cycles.
fn error_after_first(rate: f64, time: f64, watch: f64) -> f64 {
    let expected = rate * watch;
    let none = libm::exp(-expected);
    let some = expected / (1.0 - none).max(1e-9);
    let bias = libm::log(some / (time + watch) / rate);
    let squared = bias * bias + MEAN_OF_NORMAL * expected / (some * some);
    none * LN_10 + (1.0 - none) * libm::sqrt(squared).min(LN_10)
}

fn normalised(distribution: Distribution) -> Distribution {
    let sum: f64 = distribution.iter().sum();
    distribution.map(|probability| probability / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(cycles: f64, time: f64) -> Watched {
        Watched { cycles, time, estimate: cycles / time, run: time, past_variance: 0.0 }
    }

    #[test]
    fn longer_watches_gain_more_but_never_more_than_there_is() {
        let rates = Rates::new();
        let flat = [1.0 / RATES as f64; RATES];
        for bin in [0, 10, BINS - 1] {
            let (silent, gains) = rates.silent(&flat, bin);
            assert!(gains.is_sorted() && gains[0] >= 0.0, "{gains:?}");
            assert!(gains[7] < silent * LN_10);
        }
        for cycles in [0.5, 2.0, 3.0, 50.0] {
            let Expected { distribution, anew, continued } = rates.of_changed(&seen(cycles, 100.0), &flat);
            assert!((distribution.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            assert!(anew.iter().chain(&continued).all(|gain| (0.0..=LN_10).contains(gain)));
            assert!(
                anew.iter().zip(&continued).all(|(anew, continued)| anew <= continued),
                "{cycles} cycles"
            );
        }
    }

    #[test]
    fn long_silence_makes_a_change_unlikely() {
        let rates = Rates::new();
        let flat = [1.0 / RATES as f64; RATES];
        let bins = [0.0, 3.0, 15.9, 16.0, 100.0, 1e4, 1e300].map(Rates::bin);
        assert!(bins.is_sorted() && bins[6] == BINS - 1);
        let silent = |time: f64| rates.silent(&flat, Rates::bin(time)).0;
        assert!(silent(1000.0) < silent(10.0));
    }

    #[test]
    fn the_posterior_is_near_the_observed_rate() {
        let rates = Rates::new();
        let mean = |of: Distribution| {
            of.iter().zip(rates.logs).map(|(probability, log)| probability * log).sum::<f64>()
        };
        let seen = seen(2.0, 200.0);
        let flat = [1.0 / RATES as f64; RATES];
        let posterior = rates.of_changed(&seen, &flat).distribution;
        assert!((mean(posterior) - libm::log(0.01)).abs() < 0.5, "{posterior:?}");
        assert!((mean(rates.around(0.01)) - libm::log(0.01)).abs() < 0.1);
    }

    #[test]
    fn extreme_observations_give_finite_results() {
        let rates = Rates::new();
        let flat = [1.0 / RATES as f64; RATES];
        for cycles in [0.0, 0.5, 1e9] {
            for time in [0.0, 1.0, 1e300] {
                for estimate in [0.0, 1e-300, 1e300] {
                    for run in [0.0, time] {
                        let seen = Watched { cycles, time, estimate, run, past_variance: 0.0 };
                        let Expected { distribution, anew, continued } = rates.of_changed(&seen, &flat);
                        assert!(
                            distribution
                                .iter()
                                .chain(&anew)
                                .chain(&continued)
                                .all(|figure| figure.is_finite())
                        );
                    }
                }
            }
        }
    }
}

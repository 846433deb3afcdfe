//! The expected decrease of the error of a cell's rate when the cell is observed.
//!
//! The error of an estimate r̂ of a rate r is |ln(r̂ / r)|, at most ln 10, and ln 10 without an estimate:
//! over- and underestimates weigh the same. Rates are cycles per unit of time: blocked, free and blocked
//! again.

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

/// The expected error after n cycles in view is SCATTER / √(n + HALF): the scatter of a Poisson number, where the first
/// cycle does not yet tell the rate.
const SCATTER: f64 = 0.9;
const HALF: f64 = 0.5;
/// The square of the mean deviation of a normal variable over its variance, 2 / π.
const MEAN_OF_NORMAL: f64 = std::f64::consts::FRAC_2_PI;
/// The pseudocounts of a rate: half a cycle in ten units of time.
const PRIOR_CYCLES: f64 = 0.5;
const PRIOR_TIME: f64 = 10.0;
/// Bins of observation times have width 1 up to this number; then their widths grow by the factor [`BIN_RATIO`].
const FINE_BINS: usize = 16;
const BIN_RATIO: f64 = 1.15;
pub(super) const BINS: usize = 64;

/// Tables over discrete rates and observation times.
#[derive(Clone, Debug)]
pub(super) struct Rates {
    logs: Distribution,
    /// The probability of no event, for each observation time and each rate.
    silence: Vec<Distribution>,
    /// The gain of each duration for a cell without an event, at each rate.
    first: [Gains; RATES],
}

impl Rates {
    pub(super) fn new() -> Self {
        let rates: Distribution = std::array::from_fn(|rate| FASTEST * libm::pow(RATIO, rate as f64));
        let first = |rate: f64| WATCHES.map(|watch| LN_10 - error_after_first(rate, watch));
        let time = |bin: usize| match bin.checked_sub(FINE_BINS) {
            Some(step) => FINE_BINS as f64 * libm::pow(BIN_RATIO, step as f64),
            None => bin as f64,
        };
        Self {
            logs: rates.map(libm::log),
            silence: (0..BINS).map(|bin| rates.map(|rate| libm::exp(-rate * time(bin)))).collect(),
            first: rates.map(first),
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
        normalized(self.logs.map(|log| libm::exp(-0.5 * distance(log) * distance(log))))
    }

    /// For a cell that changed: the nearest discrete rate, and the gains of an observation. `cycles` is half the number
    /// of events in view, `time` the time in view.
    pub(super) fn of_changed(&self, cycles: f64, time: f64) -> (usize, Gains) {
        let rate = (cycles + PRIOR_CYCLES) / (time + PRIOR_TIME);
        let error = |cycles: f64| SCATTER / (cycles + HALF).sqrt();
        let now = error(cycles);
        (nearest(rate), WATCHES.map(|watch| now - error(cycles + rate * watch)))
    }
}

/// The index of the discrete rate that is nearest on a logarithmic scale.
fn nearest(rate: f64) -> usize {
    let index = libm::log(rate / FASTEST) / libm::log(RATIO);
    (index.round().max(0.0) as usize).min(RATES - 1)
}

/// The expected error of a cell without an event so far, after an observation of duration `watch`: ln 10 if
/// there is still no event (probability e^(−x) for x expected cycles), otherwise bias and scatter of the first few
/// cycles.
fn error_after_first(rate: f64, watch: f64) -> f64 {
    let expected = rate * watch;
    let none = libm::exp(-expected);
    let some = expected / (1.0 - none).max(1e-9);
    let bias = libm::log(some / watch / rate);
    let squared = bias * bias + MEAN_OF_NORMAL * expected / (some * some);
    none * LN_10 + (1.0 - none) * libm::sqrt(squared).min(LN_10)
}

pub(super) fn normalized(distribution: Distribution) -> Distribution {
    let sum: f64 = distribution.iter().sum();
    distribution.map(|probability| probability / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn longer_watches_gain_more_but_never_more_than_there_is_and_cycles_less_and_less() {
        let rates = Rates::new();
        let flat = [1.0 / RATES as f64; RATES];
        for bin in [0, 10, BINS - 1] {
            let (silent, gains) = rates.silent(&flat, bin);
            assert!(gains.is_sorted() && gains[0] >= 0.0, "{gains:?}");
            assert!(gains[7] < silent * LN_10);
        }
        for cycles in [0.5, 2.0, 3.0, 50.0] {
            let (_, gains) = rates.of_changed(cycles, 100.0);
            assert!(gains.is_sorted() && gains.iter().all(|gain| (0.0..=LN_10).contains(gain)), "{gains:?}");
        }
        // The same rate, known from more and more cycles.
        let gains = [0.5, 1.0, 2.0, 8.0, 64.0].map(|cycles| rates.of_changed(cycles, 50.0 * cycles).1[4]);
        assert!(gains.is_sorted_by(|before, after| before > after), "{gains:?}");
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
    fn the_nearest_rate_is_near_the_observed_one_and_extremes_are_finite() {
        let rates = Rates::new();
        let mean = |of: Distribution| {
            of.iter().zip(rates.logs).map(|(probability, log)| probability * log).sum::<f64>()
        };
        let (rate, _) = rates.of_changed(2.0, 200.0);
        assert!((rates.logs[rate] - libm::log(2.5 / 210.0)).abs() < 0.31);
        assert!((mean(rates.around(0.01)) - libm::log(0.01)).abs() < 0.1);
        for cycles in [0.0, 0.5, 1e9] {
            for time in [0.0, 1.0, 1e300] {
                assert!(rates.of_changed(cycles, time).1.iter().all(|gain| gain.is_finite()));
            }
        }
    }
}

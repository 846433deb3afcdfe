//! What watching a cell is expected to take from the error of its rate.
//!
//! The error of an estimate r̂ of a rate r is |ln(r̂ / r)|, at most ln 10, and ln 10 without an estimate:
//! over- and underestimates weigh the same. Rates are cycles per unit of time: blocked, free and blocked
//! again. Events of a thing that moves by rule are more regular than by chance. In a watch of x cycles on
//! end their number varies by x / (1 + x / φ): by x, as Poisson's, where that is little, and never by more
//! than φ, since a regular thing is at most one event off at each end of the watch. So a watch on end
//! tells more than the same time in pieces.

use std::f64::consts::LN_10;

/// How long the robot might watch, in the unit of the readings' times.
pub(super) const WATCHES: [f64; 8] = [1.0, 4.0, 10.0, 20.0, 40.0, 80.0, 160.0, 320.0];
/// The expected gain of each of [`WATCHES`], in units of the error.
pub(super) type Gains = [f64; WATCHES.len()];

/// The rates that are told apart.
pub(super) const RATES: usize = 14;
/// How likely each of them is.
pub(super) type Odds = [f64; RATES];
/// The fastest, and each to the one before: from 3 to 8000 units of time per cycle.
const FASTEST: f64 = 0.3;
const RATIO: f64 = 0.55;

/// φ: the most by which the number of cycles in one watch varies.
const MOST_VARIANCE: f64 = 0.5;
/// The square of the mean deviation of a normal variable over its variance, 2 / π.
const MEAN_OF_NORMAL: f64 = std::f64::consts::FRAC_2_PI;
/// From so many cycles on the rate itself is taken for known, not its order of magnitude only.
const KNOWN_CYCLES: f64 = 3.0;
/// The pseudocounts of a rate: half a cycle in ten units of time.
const PRIOR_CYCLES: f64 = 0.5;
const PRIOR_TIME: f64 = 10.0;
/// Times watched are told apart exactly up to here, then by steps of [`BIN_RATIO`].
const FINE_BINS: usize = 16;
const BIN_RATIO: f64 = 1.15;
const BINS: usize = 64;

/// What was seen of a cell that changed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watched {
    /// Half the events in view.
    pub(super) cycles: f64,
    /// The time in view.
    pub(super) time: f64,
    /// The rate by the estimator in use; 0 without one.
    pub(super) estimate: f64,
    /// The time of it that the cell has been in view on end up to now.
    pub(super) run: f64,
    /// By how much the number of cycles varied in earlier runs.
    pub(super) past_variance: f64,
}

impl Watched {
    /// A rate that is never zero.
    pub(super) fn rate(&self) -> f64 {
        (self.cycles + PRIOR_CYCLES) / (self.time + PRIOR_TIME)
    }
}

/// By how much the number of cycles in a watch of `cycles` on end varies.
pub(super) fn variance(cycles: f64) -> f64 {
    cycles / (1.0 + cycles / MOST_VARIANCE)
}

/// What to expect of a cell that changed: how fast it is, and what it gains by a new watch, or by one
/// that goes on without a gap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expected {
    pub(super) odds: Odds,
    pub(super) anew: Gains,
    pub(super) on_end: Gains,
}

/// Tables over rates and times watched.
#[derive(Clone, Debug)]
pub(super) struct Rates {
    rates: Odds,
    logs: Odds,
    /// Of each time watched, the probability of no event at each rate.
    silence: Vec<Odds>,
    /// The gain of each watch of a cell without an event, at each rate.
    first: [Gains; RATES],
}

impl Rates {
    pub(super) fn new() -> Self {
        let rates: Odds = std::array::from_fn(|rate| FASTEST * libm::pow(RATIO, rate as f64));
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

    /// The number of the table line for so long a watch without an event.
    pub(super) fn bin(time: f64) -> usize {
        let fine = FINE_BINS as f64;
        if time < fine {
            return time.max(0.0) as usize;
        }
        let step = libm::log(time / fine) / libm::log(BIN_RATIO);
        ((fine + step.round()) as usize).min(BINS - 1)
    }

    /// The number of table lines.
    pub(super) const fn bins() -> usize {
        BINS
    }

    /// For a cell that changes, at rates of these odds: the probability that it showed nothing for
    /// so long, and the gains of watching it in the cases in which it did not.
    pub(super) fn silent(&self, odds: &Odds, bin: usize) -> (f64, Gains) {
        let (mut silent, mut gains) = (0.0, Gains::default());
        for ((odds, silence), first) in odds.iter().zip(&self.silence[bin]).zip(&self.first) {
            let odds = odds * silence;
            silent += odds;
            gains.iter_mut().zip(first).for_each(|(gain, first)| *gain += odds * first);
        }
        (silent, gains)
    }

    /// Odds around a rate, on a scale of logarithms; each rate is about twice the next.
    pub(super) fn around(&self, rate: f64) -> Odds {
        const SPREAD: f64 = 0.6;
        let middle = libm::log(rate);
        let distance = |log: f64| ((log - middle) / SPREAD).clamp(-20.0, 20.0);
        normalised(self.logs.map(|log| libm::exp(-0.5 * distance(log) * distance(log))))
    }

    /// What to expect of a cell that changed, at rates of odds `prior` before it was watched.
    pub(super) fn of_changed(&self, seen: &Watched, prior: &Odds) -> Expected {
        if seen.cycles >= KNOWN_CYCLES && seen.estimate > 0.0 {
            self.of_known(seen)
        } else {
            self.of_hardly_known(seen, prior)
        }
    }

    /// The error is the spread √(2 V / π) / n of n cycles of variance V.
    fn of_known(&self, seen: &Watched) -> Expected {
        let rate = seen.rate();
        let spread = |variance: f64, cycles: f64| libm::sqrt(MEAN_OF_NORMAL * variance) / cycles;
        let so_far = seen.past_variance + variance(rate * seen.run).max(0.02);
        let now = spread(so_far, seen.cycles);
        let gain = |variance: f64, watch: f64| (now - spread(variance, seen.cycles + rate * watch)).max(0.0);
        Expected {
            odds: self.nearest(rate),
            anew: WATCHES.map(|watch| gain(so_far + variance(rate * watch), watch)),
            on_end: WATCHES
                .map(|watch| gain(seen.past_variance + variance(rate * (seen.run + watch)).max(0.02), watch)),
        }
    }

    /// The error is averaged over the rates that the cell may have. At each it is the bias of the
    /// estimate, and the spread of the cycles still to come.
    fn of_hardly_known(&self, seen: &Watched, prior: &Odds) -> Expected {
        let &Watched { cycles, time, estimate, run, past_variance } = seen;
        let mut odds: Odds = std::array::from_fn(|rate| {
            let expected = (self.rates[rate] * time).max(1e-9);
            cycles * libm::log(expected) - expected + libm::log(prior[rate].max(1e-300))
        });
        let top = odds.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        odds = normalised(odds.map(|log| libm::exp(log - top)));
        // Half the spread so far: the other half is that of the odds.
        let half = 0.5 * (past_variance + variance(seen.rate() * run).max(0.02));
        let has_estimate = estimate > 0.0 && cycles > 0.0;
        let estimate_time = if has_estimate { cycles / estimate } else { time };
        let (mut anew, mut on_end) = (Gains::default(), Gains::default());
        for (rate, odds) in self.rates.into_iter().zip(odds).filter(|(_, odds)| *odds > 1e-4) {
            let error = |bias: f64, variance: f64, cycles: f64| {
                let squared = bias * bias + MEAN_OF_NORMAL * variance / (cycles * cycles);
                libm::sqrt(squared).min(LN_10)
            };
            let now =
                if has_estimate { error(libm::log(estimate / rate), half, cycles.max(0.5)) } else { LN_10 };
            for (place, watch) in WATCHES.into_iter().enumerate() {
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
                anew[place] += odds * (now - first);
                on_end[place] += odds * (now - longer);
            }
        }
        // What is believed can make an estimate better than it will be; a look is never a loss.
        Expected { odds, anew: anew.map(|gain| gain.max(0.0)), on_end: on_end.map(|gain| gain.max(0.0)) }
    }

    fn nearest(&self, rate: f64) -> Odds {
        let place = libm::log(rate / FASTEST) / libm::log(RATIO);
        let nearest = (place.round().max(0.0) as usize).min(RATES - 1);
        std::array::from_fn(|rate| if rate == nearest { 1.0 } else { 0.0 })
    }
}

/// The expected error of a cell without an event so far, after another `watch`: ln 10 if there is still
/// none, with probability e^(−x) for x cycles expected; else the bias and spread of the first few.
fn error_after_first(rate: f64, time: f64, watch: f64) -> f64 {
    let expected = rate * watch;
    let none = libm::exp(-expected);
    let some = expected / (1.0 - none).max(1e-9);
    let bias = libm::log(some / (time + watch) / rate);
    let squared = bias * bias + MEAN_OF_NORMAL * expected / (some * some);
    none * LN_10 + (1.0 - none) * libm::sqrt(squared).min(LN_10)
}

fn normalised(odds: Odds) -> Odds {
    let sum: f64 = odds.iter().sum();
    odds.map(|odds| odds / sum)
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
            let Expected { odds, anew, on_end } = rates.of_changed(&seen(cycles, 100.0), &flat);
            assert!((odds.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            assert!(anew.iter().chain(&on_end).all(|gain| (0.0..=LN_10).contains(gain)));
            assert!(anew.iter().zip(&on_end).all(|(anew, on_end)| anew <= on_end), "{cycles} cycles");
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
    fn odds_turn_to_the_rate_that_was_seen() {
        let rates = Rates::new();
        let mean = |odds: Odds| odds.iter().zip(rates.logs).map(|(odds, log)| odds * log).sum::<f64>();
        let seen = seen(2.0, 200.0);
        let flat = [1.0 / RATES as f64; RATES];
        let posterior = rates.of_changed(&seen, &flat).odds;
        assert!((mean(posterior) - libm::log(0.01)).abs() < 0.5, "{posterior:?}");
        assert!((mean(rates.around(0.01)) - libm::log(0.01)).abs() < 0.1);
    }

    #[test]
    fn absurd_figures_leave_numbers() {
        let rates = Rates::new();
        let flat = [1.0 / RATES as f64; RATES];
        for cycles in [0.0, 0.5, 1e9] {
            for time in [0.0, 1.0, 1e300] {
                for estimate in [0.0, 1e-300, 1e300] {
                    for run in [0.0, time] {
                        let seen = Watched { cycles, time, estimate, run, past_variance: 0.0 };
                        let Expected { odds, anew, on_end } = rates.of_changed(&seen, &flat);
                        assert!(odds.iter().chain(&anew).chain(&on_end).all(|figure| figure.is_finite()));
                    }
                }
            }
        }
    }
}

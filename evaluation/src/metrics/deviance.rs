//! Predictive deviance: how well a rate map predicts the events that follow.
//!
//! The log error compares rates with the past that the robot has seen, and only over cells that truly changed: a wrong rate
//! of a cell that has not changed yet costs nothing. The deviance of the events to come has no such gap.

use super::statistics::Mean;
use interfaces::{CellState, GroundTruth};
use mapper::{Mapper, RateDistribution};
use serde::{Deserialize, Serialize};

/// An estimate of fewer events than this in the time of the prediction, and than the mean over the cells, counts as the smaller of
/// both. Poisson deviance is infinite where an estimate of 0 meets an event.
const MIN_EXPECTED: f64 = 0.1;

/// The prior of the ceiling counts as this many events: few enough that counts decide, and enough that a cell without an
/// event is not taken for static. The shape that fits the past best predicts less, since places do not stay the same.
const FULL_VIEW_EVENTS: f64 = 0.3;

/// The Poisson deviance of pairs of an observed and an expected count: twice the logarithm of the ratio of the likelihoods
/// of the observed and the expected counts. 0 if all are equal, ∞ if a count with the expectation 0 is observed.
pub fn poisson_deviance(counts: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    let of_count = |(observed, expected): (f64, f64)| {
        let surprise = if observed > 0.0 { observed * libm::log(observed / expected) } else { 0.0 };
        2.0 * (surprise - (observed - expected))
    };
    counts.into_iter().map(of_count).sum()
}

/// A rate map frozen at a time, over traversable cells.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct FrozenRates {
    time: f64,
    /// The mean rate of a traversable cell as far as the robot knows.
    constant: f64,
    cells: Vec<FrozenCell>,
}

/// A traversable cell: free in the map, or ever changed.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct FrozenCell {
    index: u32,
    /// The estimated rate, and that of a robot that saw everything.
    rates: [f64; 2],
    /// The true events so far.
    events: u32,
}

/// How well the frozen rates predicted the true events from the time `from` up to the time `to`.
///
/// The explained deviance 1 − D/D₀ is 1 for a perfect prediction and 0 for one as good as the constant of D₀; it has no
/// lower limit. Estimates of less than 0.1 events in this time count as 0.1, or as the mean if the mean is smaller; so rates
/// with a cell without events come close to 1, but do not reach it. The constants count as they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DevianceScores {
    /// The time at which the rates were frozen; `None` before the end of the first prediction.
    pub from: Option<f64>,
    /// The end of the prediction.
    pub to: Option<f64>,
    /// The explained Poisson deviance, against the best constant in hindsight: the mean rate of what followed.
    pub predictive_deviance: Option<f64>,
    /// The same against the constant known at `from`: the mean rate that the robot has observed over traversable cells.
    pub predictive_deviance_known: Option<f64>,
    /// The ceiling of `predictive_deviance`: the rates of a robot that had every cell in view up to `from`, with a prior of
    /// 0.3 events at the mean rate.
    pub predictive_deviance_ceiling: Option<f64>,
}

impl FrozenRates {
    /// The rates of `mapper` now.
    pub fn of(mapper: &Mapper, truth: &impl GroundTruth) -> Self {
        Self::estimated(mapper, truth, |index| mapper.rate(index))
    }

    /// Other rates of the traversable cells of `mapper`, by the index of the cell.
    pub(super) fn estimated(mapper: &Mapper, truth: &impl GroundTruth, rate: impl Fn(usize) -> f64) -> Self {
        let time = truth.elapsed();
        let is_traversable = |&index: &usize| {
            mapper.states().cells()[index] == CellState::Free || mapper.statistics(index).events() > 0
        };
        let traversable: Vec<usize> = (0..truth.frame().len()).filter(is_traversable).collect();
        let seen = traversable.iter().map(|&index| mapper.statistics(index));
        let (cycles, in_view) = seen.fold((0.5, 0.0), |(cycles, in_view), seen| {
            (cycles + f64::from(seen.cycles()), in_view + seen.observed())
        });
        let events = |index: usize| truth.predicted_events(index);
        let all: f64 = traversable.iter().map(|&index| f64::from(events(index))).sum();
        let mean = (all + 0.5) / (traversable.len().max(1) as f64 * time);
        let prior = RateDistribution { events: FULL_VIEW_EVENTS, time: FULL_VIEW_EVENTS / mean };
        let cells = traversable.iter().map(|&index| FrozenCell {
            index: index as u32,
            rates: [rate(index), prior.after(events(index), time).mean()],
            events: events(index),
        });
        Self { time, constant: cycles / in_view, cells: cells.collect() }
    }

    /// Compares the prediction with the events up to now. The scores are `None` if nothing happened.
    pub fn scores(&self, truth: &impl GroundTruth) -> DevianceScores {
        let duration = truth.elapsed() - self.time;
        let observed = |cell: &FrozenCell| {
            f64::from(truth.predicted_events(cell.index as usize).saturating_sub(cell.events))
        };
        let deviance = |expected: &dyn Fn(&FrozenCell) -> f64| {
            poisson_deviance(self.cells.iter().map(|cell| (observed(cell), expected(cell))))
        };
        let mut mean = Mean::default();
        self.cells.iter().for_each(|cell| mean.add(observed(cell)));
        let best = mean.get().unwrap_or(0.0);
        let least = MIN_EXPECTED.min(best);
        let [best, known, estimate, ideal] = [
            deviance(&|_| best),
            deviance(&|_| self.constant * duration),
            deviance(&|cell| (cell.rates[0] * duration).max(least)),
            deviance(&|cell| (cell.rates[1] * duration).max(least)),
        ];
        let explained = |of: f64, by: f64| (mean.get()? > 0.0).then_some(1.0 - of / by);
        DevianceScores {
            from: Some(self.time),
            to: Some(truth.elapsed()),
            predictive_deviance: explained(estimate, best),
            predictive_deviance_known: explained(estimate, known),
            predictive_deviance_ceiling: explained(ideal, best),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;

    #[test]
    fn the_mean_is_the_best_constant_and_only_the_counts_themselves_are_perfect() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for _ in 0..200 {
            let counts: Vec<f64> = (0..10).map(|_| f64::from(random.random_range(0..6_u32))).collect();
            let mean = counts.iter().sum::<f64>() / 10.0;
            let of_constant = |constant: f64| poisson_deviance(counts.iter().map(|&count| (count, constant)));
            let other = mean * random.random_range(0.1..3.0);
            assert!(of_constant(mean) <= of_constant(other), "{counts:?}: {mean} and {other}");
            assert_eq!(poisson_deviance(counts.iter().map(|&count| (count, count))), 0.0);
            let shifted = poisson_deviance(counts.iter().map(|&count| (count, count + 0.1)));
            assert!(shifted > 0.0, "{counts:?}");
        }
    }

    #[test]
    fn an_event_where_none_can_be_has_an_infinite_deviance() {
        assert_eq!(poisson_deviance([(1.0, 0.0)]), f64::INFINITY);
        assert_eq!(poisson_deviance([(0.0, 0.0)]), 0.0);
    }
}

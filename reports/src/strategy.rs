//! The results of one strategy: curves, areas, and the units of averages and pairs.

use super::measure::{Measure, area};
use super::statistics::{Estimate, Moments, Quantiles};
use evaluation::trials::{Metric, Trial};

/// The results of one strategy.
#[derive(Clone, Debug)]
pub struct StrategyResult {
    /// The name of the strategy.
    pub name: String,
    /// The number of trials of the strategy.
    pub trials: usize,
    /// For each strategy of the agent, the mean share of the goals that it selected.
    pub strategy_share: Vec<(String, f64)>,
    /// The number of change events on static cells, in all trials.
    pub false_change_events: u64,
    /// The number of changes of static cells in the map, in all trials.
    pub false_map_changes: u64,
    /// The number of collisions while the robot moved, in all trials; `None` in grid worlds.
    pub collisions: Option<u64>,
    /// The times of the samples: steps, or s in physics worlds.
    pub times: Vec<u64>,
    /// The trials (over all worlds: the worlds), in the order of their keys.
    pub(super) units: Vec<Unit>,
    /// One per metric and sample, in the order of [`Metric::ALL`].
    curves: Vec<Vec<Estimate>>,
    /// One per metric.
    areas: Vec<f64>,
}

/// The unit of averages and pairs: a trial, or a world averaged over its trials.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    /// The seed, or the number of the world.
    pub(super) key: u64,
    /// One per measure of [`Measure::COMPARED`].
    values: [f64; Measure::COMPARED.len()],
}

impl Unit {
    /// The value of a measure that is compared; NaN for another measure.
    pub(super) fn value(&self, measure: Measure) -> f64 {
        let compared = Measure::COMPARED.iter().position(|compared| *compared == measure);
        compared.map_or(f64::NAN, |at| self.values[at])
    }
}

impl StrategyResult {
    /// The mean and its 95 % confidence interval at every sample, over the trials (in the run over all worlds: over
    /// the worlds).
    pub fn curve(&self, metric: Metric) -> &[Estimate] {
        &self.curves[metric as usize]
    }

    /// The mean over the trials (in the run over all worlds: over the worlds); NaN if the measure is undefined in
    /// all of them.
    pub fn value(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Final(metric) => self.curve(metric).last().map_or(f64::NAN, |last| last.mean),
            Measure::Area(metric) => self.areas[metric as usize],
        }
    }
}

/// The results of one strategy while its trials, or its results in single worlds, arrive in the order of their keys. The
/// memory for a trial is that of a [`Unit`].
pub(super) struct StrategySums {
    name: String,
    times: Vec<u64>,
    trials: usize,
    shares: MeanShares,
    false_change_events: u64,
    false_map_changes: u64,
    collisions: Option<u64>,
    units: Vec<Unit>,
    /// One per metric and sample.
    curves: Vec<Vec<Moments>>,
    /// One per metric.
    areas: Vec<Moments>,
}

impl StrategySums {
    /// No trial yet.
    pub(super) fn new(name: &str, times: &[u64]) -> Self {
        Self {
            name: name.to_owned(),
            times: times.to_vec(),
            trials: 0,
            shares: MeanShares::default(),
            false_change_events: 0,
            false_map_changes: 0,
            collisions: Some(0),
            units: Vec::new(),
            curves: vec![vec![Moments::default(); times.len()]; Metric::ALL.len()],
            areas: vec![Moments::default(); Metric::ALL.len()],
        }
    }

    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Adds a trial.
    pub(super) fn add_trial(&mut self, trial: &Trial) {
        let curve = |metric: Metric| trial.samples.iter().map(|sample| metric.of(sample)).collect();
        let curves: Vec<Vec<f64>> = Metric::ALL.map(curve).into();
        let areas: Vec<f64> = curves.iter().map(|curve| area(&self.times, curve)).collect();
        self.add_unit(trial.seed, &curves, &areas);
        self.trials += 1;
        self.shares.add(&trial.strategy_share);
        self.add_counts(trial.false_change_events, trial.false_map_changes, trial.collisions);
    }

    /// Adds the result in the world with a number.
    pub(super) fn add_world(&mut self, number: u64, world: &StrategyResult) {
        let means = |curve: &Vec<Estimate>| curve.iter().map(|at| at.mean).collect();
        let curves: Vec<Vec<f64>> = world.curves.iter().map(means).collect();
        self.add_unit(number, &curves, &world.areas);
        self.trials += world.trials;
        self.shares.add(&world.strategy_share);
        self.add_counts(world.false_change_events, world.false_map_changes, world.collisions);
    }

    fn add_counts(&mut self, false_change_events: u64, false_map_changes: u64, collisions: Option<u64>) {
        self.false_change_events += false_change_events;
        self.false_map_changes += false_map_changes;
        self.collisions = self.collisions.zip(collisions).map(|(sum, count)| sum + count);
    }

    fn add_unit(&mut self, key: u64, curves: &[Vec<f64>], areas: &[f64]) {
        for (sums, curve) in self.curves.iter_mut().zip(curves) {
            sums.iter_mut().zip(curve).for_each(|(sum, value)| sum.add(*value));
        }
        self.areas.iter_mut().zip(areas).for_each(|(sum, value)| sum.add(*value));
        let values = Measure::COMPARED.map(|measure| match measure {
            Measure::Final(metric) => curves[metric as usize].last().copied().unwrap_or(f64::NAN),
            Measure::Area(metric) => areas[metric as usize],
        });
        self.units.push(Unit { key, values });
    }

    /// The results of everything that was added.
    pub(super) fn finish(self, quantiles: &Quantiles) -> StrategyResult {
        let curve = |metric: Metric| {
            let sums = self.curves[metric as usize].iter();
            sums.map(|values| quantiles.estimate(values).within(metric.range())).collect()
        };
        StrategyResult {
            trials: self.trials,
            strategy_share: self.shares.means,
            false_change_events: self.false_change_events,
            false_map_changes: self.false_map_changes,
            collisions: self.collisions,
            curves: Metric::ALL.map(curve).into(),
            areas: self.areas.iter().map(Moments::mean).collect(),
            name: self.name,
            times: self.times,
            units: self.units,
        }
    }
}

/// The mean of every share, in the order of first occurrence; a share that a list lacks is 0 in it.
#[derive(Default)]
struct MeanShares {
    lists: usize,
    means: Vec<(String, f64)>,
}

impl MeanShares {
    fn add(&mut self, list: &[(String, f64)]) {
        self.lists += 1;
        for (name, _) in list {
            if !self.means.iter().any(|(known, _)| known == name) {
                self.means.push((name.clone(), 0.0));
            }
        }
        for (name, mean) in &mut self.means {
            let share: f64 = list.iter().filter(|(of, _)| of == name).map(|(_, share)| share).sum();
            *mean += (share - *mean) / self.lists as f64;
        }
    }
}

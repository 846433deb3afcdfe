//! The results of one strategy: curves, areas, and the units of averages and pairs.

use super::metric::{Measure, Metric, Trial, area};
use super::statistics::{Estimate, Quantiles, mean};

/// The results of one strategy.
#[derive(Clone, Debug)]
pub struct StrategyResult {
    /// The name of the strategy.
    pub name: String,
    /// The number of trials of the strategy.
    pub trials: usize,
    /// The seeds of the trials and the hashes of the maps; empty in the run over all worlds.
    pub map_hashes: Vec<(u64, String)>,
    /// For each strategy of the agent, the mean share of the goals that it selected.
    pub strategy_share: Vec<(String, f64)>,
    /// The number of change events on static cells, in all trials.
    pub false_change_events: u64,
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
    /// One per metric and sample.
    curves: Vec<Vec<f64>>,
    /// One per metric.
    areas: Vec<f64>,
}

impl Unit {
    pub(super) fn value(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Final(metric) => self.curves[metric as usize].last().copied().unwrap_or(f64::NAN),
            Measure::Area(metric) => self.areas[metric as usize],
        }
    }
}

impl StrategyResult {
    /// The trials of one strategy in one world, at least one, in the order of their seeds.
    pub(super) fn in_world(trials: &[Trial], times: &[u64], quantiles: &Quantiles) -> Self {
        let unit = |trial: &Trial| {
            let curve = |metric: Metric| trial.samples.iter().map(|sample| metric.of(sample)).collect();
            let curves: Vec<Vec<f64>> = Metric::ALL.map(curve).into();
            let areas = curves.iter().map(|curve| area(times, curve)).collect();
            Unit { key: trial.seed, curves, areas }
        };
        Self {
            trials: trials.len(),
            map_hashes: trials.iter().map(|trial| (trial.seed, trial.map_hash.clone())).collect(),
            strategy_share: mean_shares(trials.iter().map(|trial| &trial.strategy_share)),
            false_change_events: trials.iter().map(|trial| trial.false_change_events).sum(),
            collisions: trials.iter().map(|trial| trial.collisions).sum(),
            ..Self::of_units(&trials[0].strategy, times, trials.iter().map(unit).collect(), quantiles)
        }
    }

    /// The run over all worlds, from the result in each world, at least one, with the number of the world.
    pub(super) fn in_all(worlds: &[(u64, &Self)], quantiles: &Quantiles) -> Self {
        let results = worlds.iter().map(|&(_, result)| result);
        let means = |curve: &Vec<Estimate>| curve.iter().map(|at| at.mean).collect();
        let unit = |&(key, result): &(u64, &Self)| Unit {
            key,
            curves: result.curves.iter().map(means).collect(),
            areas: result.areas.clone(),
        };
        let first = worlds[0].1;
        Self {
            trials: results.clone().map(|result| result.trials).sum(),
            strategy_share: mean_shares(results.clone().map(|result| &result.strategy_share)),
            false_change_events: results.clone().map(|result| result.false_change_events).sum(),
            collisions: results.map(|result| result.collisions).sum(),
            ..Self::of_units(&first.name, &first.times, worlds.iter().map(unit).collect(), quantiles)
        }
    }

    fn of_units(name: &str, times: &[u64], units: Vec<Unit>, quantiles: &Quantiles) -> Self {
        let at = |metric: Metric, sample: usize| {
            let values = units.iter().map(move |unit| unit.curves[metric as usize][sample]);
            quantiles.estimate(values).within(metric.range())
        };
        let curve = |metric| (0..times.len()).map(|sample| at(metric, sample)).collect();
        Self {
            name: name.to_owned(),
            trials: 0,
            map_hashes: Vec::new(),
            strategy_share: Vec::new(),
            false_change_events: 0,
            collisions: None,
            times: times.to_vec(),
            curves: Metric::ALL.map(curve).into(),
            areas: (0..Metric::ALL.len())
                .map(|metric| mean(units.iter().map(|unit| unit.areas[metric])))
                .collect(),
            units,
        }
    }

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

/// The mean of every share, in the order of first occurrence; a share that a list lacks is 0 in it.
fn mean_shares<'a>(lists: impl ExactSizeIterator<Item = &'a Vec<(String, f64)>>) -> Vec<(String, f64)> {
    let count = lists.len() as f64;
    let mut means: Vec<(String, f64)> = Vec::new();
    for (name, share) in lists.flatten() {
        match means.iter_mut().find(|(known, _)| known == name) {
            Some((_, sum)) => *sum += share / count,
            None => means.push((name.clone(), share / count)),
        }
    }
    means
}

//! All strategies with one estimator in one world, or over all worlds: curves, areas, comparisons.

use super::comparison::{Comparison, compare_all};
use super::metric::{Measure, Metric, Part, area};
use super::statistics::{Estimate, Quantiles, mean};
use super::trial::Trial;

/// The strategies with one estimator in one world, or over all worlds.
#[derive(Clone, Debug)]
pub struct Run {
    /// The name of the world; `all worlds (N)` for the run over all worlds.
    pub world: String,
    /// The number of worlds: 1, except in the run over all worlds.
    pub worlds: usize,
    /// The estimator's name.
    pub estimator: String,
    /// The strategies, in the order of the experiment.
    pub strategies: Vec<StrategyResult>,
    /// Every pair of strategies in every measure of [`Measure::COMPARED`].
    pub comparisons: Vec<Comparison>,
}

/// The results of one strategy.
#[derive(Clone, Debug)]
pub struct StrategyResult {
    /// The strategy's name.
    pub name: String,
    /// The number of its trials.
    pub trials: usize,
    /// The seeds of the trials and the hashes of the maps; empty in the run over all worlds.
    pub map_hashes: Vec<(u64, String)>,
    /// The mean share of the goals that each strategy of the agent chose.
    pub strategy_share: Vec<(String, f64)>,
    /// The number of change events on static cells, in all trials.
    pub false_change_events: u64,
    /// One per metric and sample, in the order of [`Metric::ALL`].
    curves: Vec<Vec<Estimate>>,
    /// One per metric.
    areas: Vec<f64>,
}

impl StrategyResult {
    /// Mean and 95 % interval over the trials (over all worlds: over the worlds) at every sample.
    pub fn curve(&self, metric: Metric) -> &[Estimate] {
        &self.curves[metric as usize]
    }

    /// The mean over the trials (over all worlds: over the worlds); not a number where it is
    /// undefined in all of them.
    pub fn value(&self, measure: Measure) -> f64 {
        match measure.part {
            Part::Final => self.curve(measure.metric).last().map_or(f64::NAN, |last| last.mean),
            Part::Area => self.areas[measure.metric as usize],
        }
    }
}

impl Run {
    /// The strategy of a name.
    pub fn strategy(&self, name: &str) -> Option<&StrategyResult> {
        self.strategies.iter().find(|strategy| strategy.name == name)
    }

    /// The difference a − b between two strategies; `None` where there is no pair of trials.
    pub fn comparison(&self, a: &str, b: &str, measure: Measure) -> Option<Comparison> {
        let mut same = self.comparisons.iter().filter(|comparison| comparison.measure == measure);
        same.find_map(|comparison| match (comparison.a == a, comparison.b == b) {
            (true, true) => Some(comparison.clone()),
            _ if comparison.a == b && comparison.b == a => Some(comparison.flipped()),
            _ => None,
        })
    }

    pub(super) fn new(
        world: String,
        worlds: usize,
        estimator: &str,
        strategies: Vec<TrialGroup>,
        quantiles: &Quantiles,
    ) -> Self {
        let comparisons = compare_all(&strategies, quantiles);
        let strategies = strategies.into_iter().map(|group| group.summary(quantiles)).collect();
        Self { world, worlds, estimator: estimator.into(), strategies, comparisons }
    }
}

/// The unit of averages and pairs: a trial, or a world averaged over its trials.
#[derive(Clone)]
pub(super) struct Unit {
    /// The seed, or the number of the world.
    pub(super) key: u64,
    /// One per metric and sample.
    curves: Vec<Vec<f64>>,
    /// One per metric.
    areas: Vec<f64>,
}

impl Unit {
    pub(super) fn last(&self, metric: Metric) -> f64 {
        self.curves[metric as usize].last().copied().unwrap_or(f64::NAN)
    }

    pub(super) fn area(&self, metric: Metric) -> f64 {
        self.areas[metric as usize]
    }

    fn of_trial(trial: &Trial, steps: &[u64]) -> Self {
        let curve = |metric: Metric| trial.samples.iter().map(|sample| metric.of(sample)).collect();
        let curves: Vec<Vec<f64>> = Metric::ALL.map(curve).into();
        let areas = curves.iter().map(|curve| area(steps, curve)).collect();
        Self { key: trial.seed, curves, areas }
    }

    /// A world: the mean of its trials.
    fn of_world(key: u64, trials: &[Self], samples: usize) -> Self {
        let over_trials =
            |metric: usize, sample: usize| trials.iter().map(move |trial| trial.curves[metric][sample]);
        let curve = |metric| (0..samples).map(|sample| mean(over_trials(metric, sample))).collect();
        let metrics = 0..Metric::ALL.len();
        Self {
            key,
            curves: metrics.clone().map(curve).collect(),
            areas: metrics.map(|metric| mean(trials.iter().map(|trial| trial.areas[metric]))).collect(),
        }
    }
}

/// All trials of one strategy.
pub(super) struct TrialGroup {
    pub(super) name: String,
    /// In the order of their keys.
    pub(super) units: Vec<Unit>,
    trials: usize,
    map_hashes: Vec<(u64, String)>,
    strategy_share: Vec<(String, f64)>,
    false_change_events: u64,
}

impl TrialGroup {
    /// The trials in one world, in the order of their seeds.
    pub(super) fn in_world(trials: &[Trial], steps: &[u64]) -> Self {
        Self {
            name: trials.first().map_or_else(String::new, |trial| trial.strategy.clone()),
            units: trials.iter().map(|trial| Unit::of_trial(trial, steps)).collect(),
            trials: trials.len(),
            map_hashes: trials.iter().map(|trial| (trial.seed, trial.map_hash.clone())).collect(),
            strategy_share: mean_shares(trials.iter().map(|trial| trial.strategy_share.as_slice())),
            false_change_events: trials.iter().map(|trial| trial.false_change_events).sum(),
        }
    }

    /// The group as one unit of the run over all worlds: the number of the world, and the mean of its trials.
    pub(super) fn as_one_world(&self, number: u64, samples: usize) -> Self {
        Self {
            name: self.name.clone(),
            units: vec![Unit::of_world(number, &self.units, samples)],
            map_hashes: Vec::new(),
            strategy_share: self.strategy_share.clone(),
            ..*self
        }
    }

    /// The run over all worlds, from one group per world.
    pub(super) fn in_all(worlds: &[Self]) -> Self {
        Self {
            name: worlds.first().map_or_else(String::new, |group| group.name.clone()),
            units: worlds.iter().flat_map(|group| group.units.iter().cloned()).collect(),
            trials: worlds.iter().map(|group| group.trials).sum(),
            map_hashes: Vec::new(),
            strategy_share: mean_shares(worlds.iter().map(|group| group.strategy_share.as_slice())),
            false_change_events: worlds.iter().map(|group| group.false_change_events).sum(),
        }
    }

    fn summary(self, quantiles: &Quantiles) -> StrategyResult {
        let samples = self.units.first().map_or(0, |unit| unit.curves[0].len());
        let units = &self.units;
        let at = |metric: usize, sample: usize| units.iter().map(move |unit| unit.curves[metric][sample]);
        let curve = |metric| (0..samples).map(|sample| quantiles.estimate(at(metric, sample))).collect();
        let metrics = 0..Metric::ALL.len();
        StrategyResult {
            curves: metrics.clone().map(curve).collect(),
            areas: metrics.map(|metric| mean(units.iter().map(|unit| unit.areas[metric]))).collect(),
            name: self.name,
            trials: self.trials,
            map_hashes: self.map_hashes,
            strategy_share: self.strategy_share,
            false_change_events: self.false_change_events,
        }
    }
}

/// The mean of every share, in the order in which they first appear; one that a list lacks is 0
/// in it.
fn mean_shares<'a>(lists: impl ExactSizeIterator<Item = &'a [(String, f64)]>) -> Vec<(String, f64)> {
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

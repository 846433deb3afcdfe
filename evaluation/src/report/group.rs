//! The trials of one strategy, as the units of averages and pairs.

use super::metric::{Metric, area};
use super::statistics::mean;
use super::trial::Trial;

/// The unit of averages and pairs: a trial, or a world averaged over its trials.
#[derive(Clone)]
pub(super) struct Unit {
    /// The seed, or the number of the world.
    pub(super) key: u64,
    /// One per metric and sample.
    pub(super) curves: Vec<Vec<f64>>,
    /// One per metric.
    pub(super) areas: Vec<f64>,
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
    pub(super) trials: usize,
    pub(super) map_hashes: Vec<(u64, String)>,
    pub(super) strategy_share: Vec<(String, f64)>,
    pub(super) false_change_events: u64,
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

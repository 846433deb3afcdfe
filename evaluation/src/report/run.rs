//! All strategies with one estimator in one world, or over all worlds: curves, areas, comparisons.

use super::ReportSettings;
use super::comparison::{Comparison, compare_all};
use super::group::TrialGroup;
use super::metric::{Measure, Metric, Part};
use super::statistics::{Estimate, Quantiles, mean};
use super::wording::thousands;

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
    fn new(group: TrialGroup, quantiles: &Quantiles) -> Self {
        let samples = group.units.first().map_or(0, |unit| unit.curves[0].len());
        let units = &group.units;
        let at = |metric: usize, sample: usize| units.iter().map(move |unit| unit.curves[metric][sample]);
        let curve = |metric| (0..samples).map(|sample| quantiles.estimate(at(metric, sample))).collect();
        let metrics = 0..Metric::ALL.len();
        Self {
            curves: metrics.clone().map(curve).collect(),
            areas: metrics.map(|metric| mean(units.iter().map(|unit| unit.areas[metric]))).collect(),
            name: group.name,
            trials: group.trials,
            map_hashes: group.map_hashes,
            strategy_share: group.strategy_share,
            false_change_events: group.false_change_events,
        }
    }

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
        let strategies = strategies.into_iter().map(|group| StrategyResult::new(group, quantiles)).collect();
        Self { world, worlds, estimator: estimator.into(), strategies, comparisons }
    }
}

/// The conditions of a run: `5 trials of 20,000 steps, estimator two-state, sensor radius 4`.
pub(super) fn conditions(run: &Run, settings: &ReportSettings) -> String {
    let (trials, steps) = (trials(run), thousands(settings.steps));
    let ReportSettings { sensor_radius, interrupted, .. } = settings;
    let short = if *interrupted { " (interrupted)" } else { "" };
    format!("{trials} of {steps} steps{short}, estimator {}, sensor radius {sensor_radius}", run.estimator)
}

/// The number of trials per strategy: `5 trials`, or `3 to 5 trials` of an interrupted run.
fn trials(run: &Run) -> String {
    let counts = run.strategies.iter().map(|strategy| strategy.trials);
    match (counts.clone().min().unwrap_or(0), counts.max().unwrap_or(0)) {
        (1, 1) => "1 trial".into(),
        (least, most) if least == most => format!("{most} trials"),
        (least, most) => format!("{least} to {most} trials"),
    }
}

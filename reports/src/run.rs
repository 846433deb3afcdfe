//! All strategies with one estimator in one world, or over all worlds.

use super::ReportSettings;
use super::comparison::{Comparison, compare_all};
use super::measure::Measure;
use super::statistics::Quantiles;
use super::strategy::StrategyResult;
use serde::{Serialize, Serializer};

/// The strategies with one estimator in one world, or over all worlds.
#[derive(Clone, Debug, Serialize)]
pub struct Run {
    /// The name of the world; `all worlds (N)` for the run over all worlds.
    pub world: String,
    /// The number of worlds: 1, except in the run over all worlds.
    #[serde(skip)]
    pub worlds: usize,
    /// The name of the estimator.
    pub estimator: String,
    /// The strategies, in the order of the experiment.
    #[serde(serialize_with = "by_name")]
    pub strategies: Vec<StrategyResult>,
    /// Every pair of strategies in every measure of [`Measure::COMPARED`].
    pub comparisons: Vec<Comparison>,
}

impl Run {
    pub(super) fn new(
        world: String,
        worlds: usize,
        estimator: &str,
        strategies: Vec<StrategyResult>,
        quantiles: &Quantiles,
    ) -> Self {
        let comparisons = compare_all(&strategies, quantiles);
        Self { world, worlds, estimator: estimator.into(), strategies, comparisons }
    }

    /// The strategy with a name; `None` if the run does not have it.
    pub fn strategy(&self, name: &str) -> Option<&StrategyResult> {
        self.strategies.iter().find(|strategy| strategy.name == name)
    }

    /// The difference a − b between two strategies; `None` if there is no pair of trials.
    pub fn comparison(&self, a: &str, b: &str, measure: Measure) -> Option<Comparison> {
        let mut same = self.comparisons.iter().filter(|comparison| comparison.measure == measure);
        same.find_map(|comparison| match (comparison.a.as_str(), comparison.b.as_str()) {
            names if names == (a, b) => Some(comparison.clone()),
            names if names == (b, a) => Some(comparison.flipped()),
            _ => None,
        })
    }
}

fn by_name<S: Serializer>(strategies: &[StrategyResult], to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(strategies.iter().map(|strategy| (&strategy.name, strategy)))
}

/// The conditions of a run: `5 trials of 20,000 steps, estimator two-state, sensor radius 4`; `3 to 5 trials` where
/// strategies have different numbers of trials, as after an interruption.
pub(super) fn conditions(run: &Run, settings: &ReportSettings) -> String {
    let counts = run.strategies.iter().map(|strategy| strategy.trials);
    let trials = match (counts.clone().min().unwrap_or(0), counts.max().unwrap_or(0)) {
        (1, 1) => "1 trial".into(),
        (least, most) if least == most => format!("{most} trials"),
        (least, most) => format!("{least} to {most} trials"),
    };
    let ReportSettings { length, sensor_radius, interrupted, .. } = settings;
    let short = if *interrupted { " (interrupted)" } else { "" };
    let sensor = sensor_radius.map_or(String::new(), |radius| format!(", sensor radius {radius}"));
    format!("{trials} of {length}{short}, estimator {}{sensor}", run.estimator)
}

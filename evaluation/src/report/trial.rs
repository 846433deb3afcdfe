//! The input of a report: the samples of the trials.

/// The metrics at the end of a step, see [`crate::metrics`]. A metric that is undefined at this step, as the
/// error of the rates before anything changed, is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The number of steps so far.
    pub step: u64,
    /// Mean relative error of the rates over the cells that truly changed.
    pub rate_error: f64,
    /// The log error of the rates: per moving thing, then over the things.
    pub log_error: f64,
    /// The share of the cells that can be seen whose mapped state is the true state.
    pub map_quality: f64,
    /// Balanced accuracy of the map on swept cells.
    pub map_quality_changing: f64,
    /// Share of the cells that can be seen that were seen.
    pub coverage: f64,
    /// Mean estimated rate over the observed static cells, 1/step.
    pub false_rate: f64,
    /// The share of the steps so far with a swept cell in view. A large share is the paper's lock-down.
    pub changing_share: f64,
    /// Brier score of the two-state model for swept cells out of view.
    pub brier: f64,
    /// The same of the state last seen.
    pub brier_last_seen: f64,
    /// The same of the average state.
    pub brier_mean: f64,
}

/// The result of one trial: a strategy with an estimator in a world.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The name of the world.
    pub world: String,
    /// The name of the estimator.
    pub estimator: String,
    /// The name of the strategy.
    pub strategy: String,
    /// The seed of all random streams. Trials of different strategies with the same seed are a pair.
    pub seed: u64,
    /// The samples in order of time: at the same steps in all trials of a report, the last at the end.
    pub samples: Vec<Sample>,
    /// The share of the goals that each strategy of the agent chose, in the order of the chooser.
    pub strategy_share: Vec<(String, f64)>,
    /// The number of change events on static cells.
    pub false_change_events: u64,
    /// The hash over all that was learned, see [`crate::map_hash`].
    pub map_hash: String,
}

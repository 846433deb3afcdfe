//! What a report is made of: looks at runs.

/// One look at a run, at the end of a step. What the measures mean is told in `metrics`; one that
/// is undefined at this step, as the error of the rates before anything changed, is not a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Steps so far.
    pub step: u64,
    /// Mean relative error of the rates over the cells that truly change.
    pub rate_error: f64,
    /// Mean error of the logarithm of the rates, per moving thing and then over the things.
    pub log_error: f64,
    /// Share of the cells that can be seen whose mapped state is true.
    pub map_quality: f64,
    /// Balanced accuracy of the map on the cells that truly change.
    pub map_quality_changing: f64,
    /// Share of the cells that can be seen that were seen.
    pub coverage: f64,
    /// Mean estimated rate over the observed cells that nothing ever touched, 1/step.
    pub false_rate: f64,
    /// Share of the steps so far with a changing cell in view: what the paper calls lock-down is
    /// a large one.
    pub changing_share: f64,
    /// Brier score of the model's probability that a changing cell out of view is blocked now.
    pub brier: f64,
    /// The same where a cell is said to be as it was last seen.
    pub brier_last_seen: f64,
    /// The same where a cell is said to be as it is on average.
    pub brier_mean: f64,
}

/// One run of a strategy with an estimator in a world.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The world's name.
    pub world: String,
    /// The estimator's name.
    pub estimator: String,
    /// The strategy's name.
    pub strategy: String,
    /// The seed of all chance. Trials of different strategies with one seed are a pair.
    pub seed: u64,
    /// The looks, in order of time: at the same steps in all trials of a report, the last at its
    /// end.
    pub samples: Vec<Sample>,
    /// How the strategy's goals were chosen: share per strategy, in the chooser's order.
    pub strategy_share: Vec<(String, f64)>,
    /// Change events on cells that nothing ever touched.
    pub false_change_events: u64,
    /// A hash of all that was learned.
    pub map_hash: String,
}

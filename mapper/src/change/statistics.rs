use super::RateDistribution;

/// The observations of one cell (paper, section 3). Times are in the time unit of the readings: seconds, or steps
/// in a grid world.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct CellStatistics {
    /// The time of the first observation, t_init.
    pub first_seen: f64,
    /// The time of the last observation, t_last.
    pub last_seen: f64,
    /// The mean time between consecutive readings (of any cells), up to the last observation of the cell; 0 before
    /// the second reading.
    pub period: f64,
    /// The time between `first_seen` and `last_seen` in which the cell was not in view, t_not obs. A cell is in
    /// view between two consecutive readings that both observed the cell.
    pub unobserved: f64,
    /// The time in view while the cell was free.
    pub watched_free: f64,
    /// The time in view while the cell was blocked.
    pub watched_blocked: f64,
    /// Changes from free to blocked in view, n_block.
    pub block_events: u32,
    /// Changes from blocked to free in view, n_free.
    pub free_events: u32,
    /// Changes from free to blocked that were found at the end of a gap in the view.
    pub block_events_after_gap: u32,
    /// Changes from blocked to free that were found at the end of a gap in the view.
    pub free_events_after_gap: u32,
    /// The information in the gaps, if the estimator [weighs gaps](crate::Estimator::weighs_gaps); otherwise 0.
    pub gap_worth: GapWorth,
    /// The prior of the cycle rate that all traversable cells [share](crate::Estimator::shares_prior), once there is one.
    pub prior: Option<RateDistribution>,
}

/// The information in the gaps of a cell, expressed as an observation in view with the same information. All fields
/// are 0 if the estimator has no model of gaps.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct GapWorth {
    /// Time in view while free.
    pub watched_free: f64,
    /// Time in view while blocked.
    pub watched_blocked: f64,
    /// Changes from free to blocked. Negative if the gaps indicate a lower rate than the other observations.
    pub block_events: f64,
    /// Changes from blocked to free. Negative if the gaps indicate a lower rate than the other observations.
    pub free_events: f64,
}

impl CellStatistics {
    /// The time in view: t_last − t_not obs − t_init.
    pub fn observed(&self) -> f64 {
        self.last_seen - self.first_seen - self.unobserved
    }

    /// The cycles in view: the larger of the numbers of block events and of free events, as in equation 1.
    pub fn cycles(&self) -> u32 {
        self.block_events.max(self.free_events)
    }

    /// The posterior of the cycle rate: the prior and what was in view; `None` without a prior.
    pub fn posterior(&self) -> Option<RateDistribution> {
        Some(self.prior?.or_lively(self.cycles(), self.observed()).after(self.cycles(), self.observed()))
    }

    /// All changes of the cell, in view or not.
    pub fn events(&self) -> u32 {
        self.block_events + self.free_events + self.block_events_after_gap + self.free_events_after_gap
    }
}

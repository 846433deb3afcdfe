/// What was seen of one cell (paper, section 3). Times are in the unit of the readings: seconds,
/// or steps in a grid world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellStatistics {
    /// When the cell was first seen, t_init.
    pub first_seen: f64,
    /// When the cell was last seen, t_last.
    pub last_seen: f64,
    /// The mean time from one reading to the next, whatever they saw, until the cell was last seen; 0
    /// before the second reading.
    pub period: f64,
    /// The time between these two in which the cell was not in view, t_not obs. A cell is in view
    /// between two consecutive readings that both saw it.
    pub unobserved: f64,
    /// The time in view while the cell was free.
    pub watched_free: f64,
    /// The time in view while the cell was blocked.
    pub watched_blocked: f64,
    /// Changes from free to blocked that happened in view, n_block.
    pub block_events: u32,
    /// Changes from blocked to free that happened in view, n_free.
    pub free_events: u32,
    /// Changes from free to blocked that were found when the cell came back into view.
    pub block_events_after_gap: u32,
    /// Changes from blocked to free that were found when the cell came back into view.
    pub free_events_after_gap: u32,
    /// Gaps in the view of the cell that began while it was free.
    pub gaps_from_free: u32,
    /// Gaps in the view of the cell that began while it was blocked.
    pub gaps_from_blocked: u32,
    /// What the gaps tell, if the estimator weighs them.
    pub gap_worth: GapWorth,
}

/// What the gaps in the view of a cell tell of its rates, as the watching that would tell the same. All 0
/// if the estimator in use does not weigh gaps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GapWorth {
    /// Time watched while free.
    pub watched_free: f64,
    /// Time watched while blocked.
    pub watched_blocked: f64,
    /// Changes from free to blocked. Below 0 where the gaps speak for less than the rest.
    pub block_events: f64,
    /// Changes from blocked to free, likewise.
    pub free_events: f64,
}

impl CellStatistics {
    /// The time in view: t_last − t_not obs − t_init.
    pub fn observed(&self) -> f64 {
        self.last_seen - self.first_seen - self.unobserved
    }

    /// All changes of the cell, in view or not.
    pub fn events(&self) -> u32 {
        self.block_events + self.free_events + self.block_events_after_gap + self.free_events_after_gap
    }
}

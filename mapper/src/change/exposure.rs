use super::CellStatistics;
use std::ops::Add;

/// Exposure of a cell: per state (free, blocked) the events that ended the state, and the time in the state,
/// counted in steps of the readings. The two divided are the probability per step of leaving the state.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Exposure {
    /// Events that ended a stay in free, and in blocked.
    pub events: [f64; 2],
    /// Steps that began in free, and in blocked.
    pub steps: [f64; 2],
}

impl Exposure {
    /// The exposure in view. The statistics count the step of a change for the state after it.
    pub fn in_view(seen: &CellStatistics) -> Self {
        let (block, free) = (f64::from(seen.block_events), f64::from(seen.free_events));
        let steps = |watched: f64, own: f64, other: f64| (watched / seen.period + own - other).max(own);
        Self {
            events: [block, free],
            steps: [steps(seen.watched_free, block, free), steps(seen.watched_blocked, free, block)],
        }
    }

    /// The exposure with the information of the gaps.
    pub fn of_gaps(seen: &CellStatistics) -> Self {
        let worth = &seen.gap_worth;
        Self {
            events: [worth.block_events, worth.free_events],
            steps: [worth.watched_free / seen.period, worth.watched_blocked / seen.period],
        }
    }

    /// The same number of events and of steps in both states.
    pub fn uniform(events: f64, steps: f64) -> Self {
        Self { events: [events; 2], steps: [steps; 2] }
    }

    /// The exposure times a factor per state.
    pub fn scaled(self, factors: [f64; 2]) -> Self {
        let times = |of: [f64; 2]| [of[0] * factors[0], of[1] * factors[1]];
        Self { events: times(self.events), steps: times(self.steps) }
    }

    /// Events per step, per state.
    pub fn leave(self) -> [f64; 2] {
        [0, 1].map(|state| self.events[state] / self.steps[state])
    }
}

impl Add for Exposure {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Self { events: sum(self.events, other.events), steps: sum(self.steps, other.steps) }
    }
}

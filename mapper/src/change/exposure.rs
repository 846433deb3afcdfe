use super::CellStatistics;
use std::ops::Add;

/// The exposure of a cell: for each state (free, blocked) the number of events that ended the state, and the time
/// in the state, counted in steps of the readings. Events divided by steps are the probability per step of leaving
/// the state.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(crate) struct Exposure {
    /// The number of events that ended a free stay, and a blocked stay.
    pub(crate) events: [f64; 2],
    /// The number of steps that began free, and blocked.
    pub(crate) steps: [f64; 2],
}

impl Exposure {
    /// The exposure in view. In the statistics, the step of a change counts for the state after the change.
    pub(crate) fn in_view(seen: &CellStatistics) -> Self {
        let (block, free) = (f64::from(seen.block_events), f64::from(seen.free_events));
        let steps = |watched: f64, own: f64, other: f64| (watched / seen.period + own - other).max(own);
        Self {
            events: [block, free],
            steps: [steps(seen.watched_free, block, free), steps(seen.watched_blocked, free, block)],
        }
    }

    /// The exposure with the same information as the gaps.
    pub(crate) fn of_gaps(seen: &CellStatistics) -> Self {
        let worth = &seen.gap_worth;
        Self {
            events: [worth.block_events, worth.free_events],
            steps: [worth.watched_free / seen.period, worth.watched_blocked / seen.period],
        }
    }

    /// An exposure with the same numbers of events and steps for both states.
    pub(crate) fn uniform(events: f64, steps: f64) -> Self {
        Self { events: [events; 2], steps: [steps; 2] }
    }

    /// The exposure multiplied by one factor per state.
    pub(crate) fn scaled(self, factors: [f64; 2]) -> Self {
        let times = |of: [f64; 2]| [of[0] * factors[0], of[1] * factors[1]];
        Self { events: times(self.events), steps: times(self.steps) }
    }

    /// Events per step, for each state.
    pub(crate) fn leave(self) -> [f64; 2] {
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

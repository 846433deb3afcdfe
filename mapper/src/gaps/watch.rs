use crate::CellStatistics;
use std::ops::Add;

/// What was watched: per state (free, blocked) the events that ended it and the steps of the readings
/// that began in it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Watch {
    pub(crate) events: [f64; 2],
    pub(crate) steps: [f64; 2],
}

impl Watch {
    /// What was watched of a cell. The statistics count the step of a change for the state after it.
    pub(crate) fn of(seen: &CellStatistics) -> Self {
        let (block, free) = (f64::from(seen.block_events), f64::from(seen.free_events));
        let steps = |watched: f64, own: f64, other: f64| (watched / seen.period + own - other).max(own);
        Self {
            events: [block, free],
            steps: [steps(seen.watched_free, block, free), steps(seen.watched_blocked, free, block)],
        }
    }

    /// What the gaps of a cell are worth.
    pub(crate) fn of_gaps(seen: &CellStatistics) -> Self {
        let worth = &seen.gap_worth;
        Self {
            events: [worth.block_events, worth.free_events],
            steps: [worth.watched_free / seen.period, worth.watched_blocked / seen.period],
        }
    }

    /// So many events and steps in either state.
    pub(crate) fn of_both(events: f64, steps: f64) -> Self {
        Self { events: [events; 2], steps: [steps; 2] }
    }

    /// A part of it, per state.
    pub(crate) fn times(self, part: [f64; 2]) -> Self {
        let times = |of: [f64; 2]| [of[0] * part[0], of[1] * part[1]];
        Self { events: times(self.events), steps: times(self.steps) }
    }

    /// Events per step, per state.
    pub(crate) fn leave(self) -> [f64; 2] {
        [0, 1].map(|state| self.events[state] / self.steps[state])
    }
}

impl Add for Watch {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        Self { events: sum(self.events, other.events), steps: sum(self.steps, other.steps) }
    }
}

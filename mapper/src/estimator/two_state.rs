//! Each rate from the time in the state that it ends.

use crate::CellStatistics;
use crate::chain::Chain;
use crate::gaps::Watch;

/// What one event counts for a state that was left often but never seen to be entered again: half
/// an event, the mean of the Jeffreys posterior of a Poisson rate for no event.
const UNSEEN_EVENTS: f64 = 0.5;

/// What is known of both probabilities per step before anything is seen.
pub(crate) fn gap_prior() -> Watch {
    Watch { events: [*crate::gaps::tune::PRIOR; 2], steps: [1.0; 2] }
}

/// The mean time in each state: the time watched in it per event that ended it; none without an event in
/// view.
fn dwells(seen: &CellStatistics) -> Option<[f64; 2]> {
    if seen.block_events + seen.free_events == 0 {
        return None;
    }
    let dwell =
        |watched: f64, events: u32| watched / if events == 0 { UNSEEN_EVENTS } else { f64::from(events) };
    Some([dwell(seen.watched_free, seen.block_events), dwell(seen.watched_blocked, seen.free_events)])
}

/// T = 1/α + 1/β with α the rate of block events while free, and β of free events while blocked.
pub(super) fn interval_in_view(seen: &CellStatistics) -> f64 {
    dwells(seen).map_or(f64::INFINITY, |[free, blocked]| free + blocked)
}

/// α and β of [`interval_in_view`].
pub(super) fn in_view(seen: &CellStatistics) -> Option<Chain> {
    dwells(seen).map(|[free, blocked]| Chain { block: 1.0 / free, free: 1.0 / blocked, period: seen.period })
}

/// What was watched of the cell, in steps of the readings that began in each state. The statistics count
/// the step of a change for the state after it.
pub(crate) fn watch(seen: &CellStatistics) -> Watch {
    let (block, free) = (f64::from(seen.block_events), f64::from(seen.free_events));
    let steps = |watched: f64, own: f64, other: f64| (watched / seen.period + own - other).max(own);
    Watch {
        events: [block, free],
        steps: [steps(seen.watched_free, block, free), steps(seen.watched_blocked, free, block)],
    }
}

/// The same with what the gaps are worth, and the prior.
pub(super) fn with_gaps(seen: &CellStatistics) -> Chain {
    let worth = &seen.gap_worth;
    let worth = Watch {
        events: [worth.block_events, worth.free_events],
        steps: [worth.watched_free / seen.period, worth.watched_blocked / seen.period],
    };
    let all = watch(seen) + worth + gap_prior();
    let rate = |state: usize| all.events[state] / all.steps[state] / seen.period;
    Chain { block: rate(0), free: rate(1), period: seen.period }
}

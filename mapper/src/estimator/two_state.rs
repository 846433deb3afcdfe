//! Each rate from the time in the state that it ends.

use crate::CellStatistics;
use crate::chain::Chain;
use crate::gaps::{MEDIAN_EVENTS, Watch};

/// What one event counts for a state that was left often but never seen to be entered again: half
/// an event, the mean of the Jeffreys posterior of a Poisson rate for no event.
const UNSEEN_EVENTS: f64 = 0.5;

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

/// α and β from what was watched in each state, what the gaps are worth, and the prior.
pub(super) fn with_gaps(seen: &CellStatistics) -> Chain {
    let all = Watch::of(seen) + Watch::of_gaps(seen) + Watch::of_both(MEDIAN_EVENTS, 1.0);
    let [block, free] = all.leave().map(|leave| leave / seen.period);
    Chain { block, free, period: seen.period }
}

use super::Estimator;
use crate::change::{CellStatistics, TransitionRates};

/// `two-state`: a two-state continuous-time Markov chain with the cycle time T = 1/α + 1/β, where α is the rate of
/// block events while free, and β the rate of free events while blocked. Each rate is conditioned on the state in
/// which the cell was in view, so that longer observation while a thing is in the cell causes less bias.
#[derive(Clone, Copy, Debug)]
pub struct TwoState;

/// The assumed number of events for a state that was left in view, but never entered in view: half an event, the
/// mean of the Jeffreys posterior of a Poisson rate for no event.
const UNSEEN_EVENTS: f64 = 0.5;

/// The mean time in each state: the time in view per event that ended the state; `None` without an event in view.
fn dwells(seen: &CellStatistics) -> Option<[f64; 2]> {
    if seen.block_events + seen.free_events == 0 {
        return None;
    }
    let dwell =
        |watched: f64, events: u32| watched / if events == 0 { UNSEEN_EVENTS } else { f64::from(events) };
    Some([dwell(seen.watched_free, seen.block_events), dwell(seen.watched_blocked, seen.free_events)])
}

impl Estimator for TwoState {
    fn name(&self) -> &'static str {
        "two-state"
    }

    fn interval(&self, seen: &CellStatistics) -> f64 {
        dwells(seen).map_or(f64::INFINITY, |[free, blocked]| free + blocked)
    }

    fn transition_rates(&self, seen: &CellStatistics) -> Option<TransitionRates> {
        dwells(seen).map(|[free, blocked]| TransitionRates {
            block: 1.0 / free,
            free: 1.0 / blocked,
            period: seen.period,
        })
    }
}

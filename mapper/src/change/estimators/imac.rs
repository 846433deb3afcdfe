use super::Estimator;
use crate::change::{CellStatistics, TransitionRates};

/// `imac`: independent Markov chains of Saarinen, Andreasson & Lilienthal (IROS 2012).
///
/// For each state, λ = (events + 1) / (observations + 1) per observation. An event is a change that is found at the
/// next observation, whatever the time between.
#[derive(Clone, Copy, Debug)]
pub struct Imac;

impl Estimator for Imac {
    fn name(&self) -> &'static str {
        "imac"
    }

    fn interval(&self, seen: &CellStatistics) -> f64 {
        rates(seen).interval()
    }

    fn transition_rates(&self, seen: &CellStatistics) -> Option<TransitionRates> {
        Some(rates(seen))
    }
}

fn rates(seen: &CellStatistics) -> TransitionRates {
    let observations = |watched: f64, gaps: u32| {
        let steps = if seen.period > 0.0 { watched / seen.period } else { 0.0 };
        steps + f64::from(gaps)
    };
    let rate = |events: u32, observations: f64| f64::from(events + 1) / (observations + 1.0) / seen.period;
    let free = observations(seen.watched_free, seen.gaps_from_free);
    let blocked = observations(seen.watched_blocked, seen.gaps_from_blocked);
    TransitionRates {
        block: rate(seen.block_events + seen.block_events_after_gap, free),
        free: rate(seen.free_events + seen.free_events_after_gap, blocked),
        period: seen.period,
    }
}

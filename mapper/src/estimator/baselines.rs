//! Estimators of others, to compare with.

use crate::CellStatistics;
use crate::chain::Chain;

/// Equation 1: observed time per event, the smaller of the two processes'. They are coupled, so
/// they share one rate, and the estimate errs towards long intervals.
pub(super) fn paper(seen: &CellStatistics, block_events: u32, free_events: u32) -> f64 {
    let events = block_events.max(free_events);
    if events == 0 { f64::INFINITY } else { seen.observed() / f64::from(events) }
}

/// Saarinen, Andreasson & Lilienthal: λ = (events + 1) / (observations + 1) per state and observation.
pub(super) fn imac(seen: &CellStatistics) -> Chain {
    let observations = |watched: f64, gaps: u32| {
        let steps = if seen.period > 0.0 { watched / seen.period } else { 0.0 };
        steps + f64::from(gaps)
    };
    let rate = |events: u32, observations: f64| f64::from(events + 1) / (observations + 1.0) / seen.period;
    let free = observations(seen.watched_free, seen.gaps_from_free);
    let blocked = observations(seen.watched_blocked, seen.gaps_from_blocked);
    Chain {
        block: rate(seen.block_events + seen.block_events_after_gap, free),
        free: rate(seen.free_events + seen.free_events_after_gap, blocked),
        period: seen.period,
    }
}

/// Cho & Garcia-Molina: X of N visits at interval I found a change: −ln((N − X + ½)/(N + ½)) / I. In view
/// a visit is a reading; what is expected to have happened in gaps is counted beside it. Every second
/// change begins a cycle.
pub(super) fn cho_garcia_molina(seen: &CellStatistics) -> f64 {
    let time = seen.observed() + seen.unobserved;
    2.0 * time / (changes_in_view(seen) + seen.gap_worth.block_events + seen.gap_worth.free_events)
}

/// Changes in view by Cho & Garcia-Molina, those between two readings included.
pub(crate) fn changes_in_view(seen: &CellStatistics) -> f64 {
    let changed = f64::from(seen.block_events + seen.free_events);
    if changed == 0.0 {
        return 0.0;
    }
    let visits = (seen.observed() / seen.period).max(changed);
    if !visits.is_finite() {
        return changed;
    }
    -visits * libm::log((visits - changed + 0.5) / (visits + 0.5))
}

/// A cycle rate, shared between the states as the cell was seen: one cycle is 1/α free and 1/β blocked.
pub(super) fn shared(seen: &CellStatistics, cycle_rate: f64) -> Chain {
    // Half a reading more for either state, so that none has no share at all.
    let (free, blocked) = (seen.watched_free + 0.5 * seen.period, seen.watched_blocked + 0.5 * seen.period);
    let rate = |own: f64| cycle_rate * ((free + blocked) / own);
    Chain { block: rate(free), free: rate(blocked), period: seen.period }
}

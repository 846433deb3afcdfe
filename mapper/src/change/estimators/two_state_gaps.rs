use super::Estimator;
use crate::change::gaps::MEDIAN_EVENTS;
use crate::change::{CellStatistics, Exposure, TransitionRates};

/// `two-state-gaps`: the two-state Markov chain in steps of the readings, with the information in the gaps (the
/// state before, the state after, and the time between). Maximum a posteriori.
#[derive(Clone, Copy, Debug)]
pub struct TwoStateGaps;

impl Estimator for TwoStateGaps {
    fn name(&self) -> &'static str {
        "two-state-gaps"
    }

    fn interval(&self, seen: &CellStatistics) -> f64 {
        rates(seen).interval()
    }

    fn transition_rates(&self, seen: &CellStatistics) -> Option<TransitionRates> {
        Some(rates(seen))
    }

    fn weighs_gaps(&self) -> bool {
        true
    }
}

/// α and β from the exposure in view, the worth of the gaps, and the prior.
fn rates(seen: &CellStatistics) -> TransitionRates {
    let all = Exposure::in_view(seen) + Exposure::of_gaps(seen) + Exposure::uniform(MEDIAN_EVENTS, 1.0);
    let [block, free] = all.leave().map(|leave| leave / seen.period);
    TransitionRates { block, free, period: seen.period }
}

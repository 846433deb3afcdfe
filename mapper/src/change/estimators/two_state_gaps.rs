use super::Estimator;
use crate::change::gaps::MEDIAN_EVENTS;
use crate::change::gaps::fit::Observations;
use crate::change::transition_kernel::Step;
use crate::change::{
    CellStatistics, Exposure, GapEvidence, GapHistogram, GapModel, GapWeights, TransitionRates,
};

/// `two-state-gaps`: the two-state Markov chain in steps of the readings, with the information in the gaps (the
/// state before, the state after, and the time between). Maximum a posteriori.
#[derive(Clone, Copy, Debug)]
pub struct TwoStateGaps;

/// If stays are equally long, a stay that was in view from begin to end counts as this many additional stays of a
/// chain: one stay shows the length of all.
const WHOLE_STAY: f64 = 3.0;

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

    fn gap_model(&self) -> Option<&dyn GapModel> {
        Some(self)
    }
}

/// α and β from the exposure in view, the worth of the gaps, and the prior.
fn rates(seen: &CellStatistics) -> TransitionRates {
    let all = Exposure::in_view(seen) + Exposure::of_gaps(seen) + Exposure::uniform(MEDIAN_EVENTS, 1.0);
    let [block, free] = all.leave().map(|leave| leave / seen.period);
    TransitionRates { block, free, period: seen.period }
}

impl GapModel for TwoStateGaps {
    fn weigh(&self, evidence: &GapEvidence<'_>) -> Option<GapWeights> {
        let GapEvidence { seen, gaps, neighbors, regularity, .. } = *evidence;
        let in_view = Exposure::in_view(seen);
        let more = neighbors + visit_prior(in_view, gaps, seen.period) + whole_stays(evidence);
        let exposure = in_view + more + evidence.prior;
        let observations = Observations { exposure, gaps, period: seen.period, regular: regularity };
        let fit = observations.fit(evidence.last_step.unwrap_or_else(|| slowest(seen)))?;
        Some(GapWeights {
            worth: fit.worth + more,
            neighbors,
            own: in_view + fit.worth,
            mixed: fit.mixed,
            step: Some(fit.step),
        })
    }

    fn is_two_state(&self) -> bool {
        true
    }
}

/// The number of steps without an event that gives the prior the weight of one visit: the harmonic mean of the time
/// between two observations. The rate of a cell that changes much faster than it was observed cannot be known; the
/// estimate is then the slowest rate that explains the observations.
fn visit_prior(in_view: Exposure, gaps: &GapHistogram, period: f64) -> Exposure {
    let steps = in_view.steps[0] + in_view.steps[1];
    let (mut visits, mut pace) = (steps, steps);
    for bin in gaps.iter() {
        let count = f64::from(bin.count);
        visits += count;
        pace += count * period / bin.length();
    }
    let visit = visits / pace;
    Exposure::uniform(0.0, if visit > 1.0 && visit.is_finite() { visit - 1.0 } else { 0.0 })
}

/// The information in complete stays, in addition to their time in view. Mostly it is the state with the shorter
/// stays that has complete stays; of the other state, only the shortest stays fit into a visit, and they count
/// little.
fn whole_stays(evidence: &GapEvidence<'_>) -> Exposure {
    let Some(Step { block, free }) = evidence.last_step else { return Exposure::default() };
    let [blocked, unblocked] = [block, free].map(|leave| leave / (block + free));
    let regular = evidence.regularity;
    let part = [blocked * blocked * regular[0], unblocked * unblocked * regular[1]];
    evidence.whole_stays.scaled(part.map(|part| WHOLE_STAY * part))
}

/// The slowest chain that the observations of a cell allow.
fn slowest(seen: &CellStatistics) -> Step {
    let steps = (seen.last_seen - seen.first_seen) / seen.period + 1.0;
    let leave = (f64::from(seen.events().max(1)) / steps).min(0.5);
    Step { block: leave, free: leave }
}

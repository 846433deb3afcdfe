//! The information in the gaps in the view of a cell: the state before, the state after, and the time between.
//!
//! [`CellGaps`] collects the gaps of a cell and decides when they are weighed. The [`GapModel`] of the estimator
//! computes the weights.

pub(super) mod fit;
mod histogram;
pub(super) mod neighbors;
mod regularity;

use super::transition_kernel::Step;
use super::{CellStatistics, Exposure, GapWorth};
pub(super) use histogram::Gap;
pub use histogram::{GapBin, GapHistogram};
pub(super) use regularity::Regularity;

/// The number of events of a cell without any observation, in one step. With Jeffreys' prior the rate after n
/// events has the distribution Γ(n + ½). The median of this distribution, which is as often too high as too low, is
/// that of n + ⅙ events.
pub(super) const MEDIAN_EVENTS: f64 = 1.0 / 6.0;
/// The number of events, in one step, that gives the mean of that distribution.
pub(super) const MEAN_EVENTS: f64 = 0.5;

/// Gaps are weighed again when the number of events and gaps, or the time in view, has grown by these shares. The
/// work per gap is bounded, and little information is missing in between.
const COUNTED_GROWTH: f64 = 1.0 / 8.0;
const WATCHED_GROWTH: f64 = 1.0 / 4.0;

/// Computes the information that the gaps of a cell give about its rates.
pub trait GapModel {
    /// Weighs the gaps of a cell. With `None`, the previous result is kept.
    fn weigh(&self, evidence: &GapEvidence<'_>) -> Option<GapWeights>;

    /// Whether [`GapWeights::worth`] is the exposure of a two-state chain. Only then do credible intervals take the
    /// gaps into account.
    fn is_two_state(&self) -> bool {
        false
    }
}

/// The inputs of a [`GapModel`] for one cell.
#[derive(Clone, Copy, Debug)]
pub struct GapEvidence<'a> {
    /// The statistics of the cell.
    pub seen: &'a CellStatistics,
    /// The gaps.
    pub gaps: &'a GapHistogram,
    /// The prior: an exposure that stands for the knowledge before any observation.
    pub prior: Exposure,
    /// The exposure of the cells nearby, weighted by how much they resemble this cell.
    pub neighbors: Exposure,
    /// The stays that began and ended with an event in view: their number, and their total number of steps.
    pub whole_stays: Exposure,
    /// For each state, the regularity of stays: from 0 (random length) to 1 (equal length). One value for the whole
    /// map.
    pub regularity: [f64; 2],
    /// [`GapWeights::step`] of the previous result.
    pub last_step: Option<Step>,
}

/// The information in the gaps of a cell. By default there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct GapWeights {
    /// The exposure that has the same information as the gaps and all other evidence out of view. It becomes
    /// [`CellStatistics::gap_worth`].
    pub worth: Exposure,
    /// The part of `worth` that comes from the neighbors.
    pub neighbors: Exposure,
    /// The exposure of this cell alone, in view and in gaps. The neighboring cells use it.
    pub own: Exposure,
    /// The mixed term of the information about both transition probabilities, in log-odds.
    pub mixed: f64,
    /// The most probable chain; the next search starts there.
    pub step: Option<Step>,
}

/// The belief about both transition probabilities of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Belief {
    /// The exposure with the same information.
    pub(crate) exposure: Exposure,
    /// See [`GapWeights::mixed`].
    pub(crate) mixed: f64,
}

/// The gaps of one cell, and their weights.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct CellGaps {
    pub(super) histogram: GapHistogram,
    /// Only of a cell that changed.
    weighed: Option<Box<Weighed>>,
}

/// The weights of the gaps when they were last weighed, and when that was.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
struct Weighed {
    weights: GapWeights,
    /// The number of gaps and events, and the time in view, at which the gaps are weighed again.
    #[serde(with = "interfaces::serde_time")]
    due: [f64; 2],
    /// For each state the length of the last stay that began and ended with an event in view, in steps; 0 before
    /// the first.
    #[serde(with = "interfaces::serde_time")]
    stays: [f64; 2],
    /// All stays that began and ended with an event in view: their number, and their total number of steps.
    whole_stays: Exposure,
}

impl CellGaps {
    /// Adds a stay of this many steps in a state that began and ended with an event in view.
    pub(super) fn add_stay(&mut self, state: usize, steps: f64, regularity: &mut Regularity) {
        let weighed = self.weighed.get_or_insert_default();
        weighed.whole_stays.events[state] += 1.0;
        weighed.whole_stays.steps[state] += steps;
        let before = std::mem::replace(&mut weighed.stays[state], steps);
        if before > 0.0 {
            regularity.add(state, before, steps);
        }
    }

    /// The previous result.
    pub(super) fn weights(&self) -> GapWeights {
        self.weighed.as_ref().map_or(GapWeights::default(), |weighed| weighed.weights)
    }

    /// The information in the gaps, with steps of length `period`.
    pub(super) fn worth(&self, period: f64) -> GapWorth {
        let Exposure { events: [block_events, free_events], steps } = self.weights().worth;
        let [watched_free, watched_blocked] = steps.map(|steps| steps * period);
        GapWorth { watched_free, watched_blocked, block_events, free_events }
    }

    /// Whether the gaps of a cell that changes must be weighed again.
    pub(super) fn is_due(&self, seen: &CellStatistics) -> bool {
        let due = self.weighed.as_ref().map_or([0.0; 2], |weighed| weighed.due);
        seen.period > 0.0 && (self.counted(seen) >= due[0] || seen.observed() >= due[1])
    }

    fn counted(&self, seen: &CellStatistics) -> f64 {
        f64::from(self.histogram.count()) + f64::from(seen.events())
    }

    fn evidence<'a>(&'a self, seen: &'a CellStatistics, regularity: &Regularity) -> GapEvidence<'a> {
        GapEvidence {
            seen,
            gaps: &self.histogram,
            prior: Exposure::uniform(MEDIAN_EVENTS, 1.0),
            neighbors: Exposure::default(),
            whole_stays: self.weighed.as_ref().map_or(Exposure::default(), |weighed| weighed.whole_stays),
            regularity: regularity.weights(),
            last_step: self.weights().step,
        }
    }

    /// Weighs the gaps of a cell that changes.
    pub(super) fn weigh(
        &mut self,
        model: &dyn GapModel,
        seen: &CellStatistics,
        neighbors: Exposure,
        regularity: &Regularity,
    ) {
        let weights = model.weigh(&GapEvidence { neighbors, ..self.evidence(seen, regularity) });
        let counted = self.counted(seen) * (1.0 + COUNTED_GROWTH) + 0.5;
        let weighed = self.weighed.get_or_insert_default();
        weighed.due = [counted, seen.observed() * (1.0 + WATCHED_GROWTH)];
        weighed.weights = weights.unwrap_or(weighed.weights);
    }

    /// The belief about the transition probabilities of a cell; also defined for a cell that never changed.
    pub(super) fn belief(
        &self,
        model: &dyn GapModel,
        seen: &CellStatistics,
        regularity: &Regularity,
    ) -> Belief {
        let prior = Exposure::uniform(MEAN_EVENTS, 1.0);
        let exposure = Exposure::in_view(seen) + prior;
        if let Some(Weighed { weights, .. }) = self.weighed.as_deref() {
            let all = exposure + weights.worth;
            // The cells nearby observed mostly the same events: they move the estimate, but do not make it more
            // certain.
            let own = [0, 1].map(|state| 1.0 - weights.neighbors.steps[state] / all.steps[state]);
            return Belief { exposure: all.scaled(own), mixed: weights.mixed };
        }
        let weights =
            model.weigh(&GapEvidence { prior, ..self.evidence(seen, regularity) }).unwrap_or_default();
        Belief { exposure: exposure + weights.worth, mixed: weights.mixed }
    }
}

//! The information in the gaps in the view of a cell: the state before, the state after, and the time between.
//!
//! [`CellGaps`] collects the gaps of a cell, decides when they are weighed, and computes their weights: maximum a posteriori of a
//! two-state Markov chain.

mod fit;
mod histogram;
pub(super) mod neighbors;
mod regularity;

use super::transition_kernel::Step;
use super::{CellStatistics, Exposure, GapWorth};
use fit::Observations;
pub(super) use histogram::Gap;
pub(super) use histogram::GapHistogram;
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
/// If stays are equally long, a stay that was in view from begin to end counts as this many additional stays of a
/// chain: one stay shows the length of all.
const WHOLE_STAY: f64 = 3.0;

/// The information in the gaps of a cell. By default there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(in crate::change) struct GapWeights {
    /// The exposure that has the same information as the gaps and all other evidence out of view. It becomes
    /// [`CellStatistics::gap_worth`].
    pub(in crate::change) worth: Exposure,
    /// The part of `worth` that comes from the neighbors.
    pub(in crate::change) neighbors: Exposure,
    /// The exposure of this cell alone, in view and in gaps. The neighboring cells use it.
    pub(in crate::change) own: Exposure,
    /// The mixed term of the information about both transition probabilities, in log-odds.
    pub(in crate::change) mixed: f64,
    /// The most probable chain; the next search starts there.
    pub(in crate::change) step: Option<Step>,
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

    /// Weighs the gaps of a cell that changes. Without a result, the previous one is kept.
    pub(super) fn weigh(&mut self, seen: &CellStatistics, neighbors: Exposure, regularity: &Regularity) {
        let weights = self.weighed_with(Exposure::uniform(MEDIAN_EVENTS, 1.0), seen, neighbors, regularity);
        let counted = self.counted(seen) * (1.0 + COUNTED_GROWTH) + 0.5;
        let weighed = self.weighed.get_or_insert_default();
        weighed.due = [counted, seen.observed() * (1.0 + WATCHED_GROWTH)];
        weighed.weights = weights.unwrap_or(weighed.weights);
    }

    /// The belief about the transition probabilities of a cell; also defined for a cell that never changed.
    pub(super) fn belief(&self, seen: &CellStatistics, regularity: &Regularity) -> Belief {
        let prior = Exposure::uniform(MEAN_EVENTS, 1.0);
        let exposure = Exposure::in_view(seen) + prior;
        if let Some(Weighed { weights, .. }) = self.weighed.as_deref() {
            let all = exposure + weights.worth;
            // The cells nearby observed mostly the same events: they move the estimate, but do not make it more
            // certain.
            let own = [0, 1].map(|state| 1.0 - weights.neighbors.steps[state] / all.steps[state]);
            return Belief { exposure: all.scaled(own), mixed: weights.mixed };
        }
        let weights = self.weighed_with(prior, seen, Exposure::default(), regularity).unwrap_or_default();
        Belief { exposure: exposure + weights.worth, mixed: weights.mixed }
    }

    /// The two-state Markov chain in steps of the readings that explains best what was seen of a cell. `prior` is an exposure that
    /// stands for the knowledge before any observation; `neighbors` is that of the cells nearby, weighted by how much they
    /// resemble this cell.
    fn weighed_with(
        &self,
        prior: Exposure,
        seen: &CellStatistics,
        neighbors: Exposure,
        regularity: &Regularity,
    ) -> Option<GapWeights> {
        let (in_view, regular, period) = (Exposure::in_view(seen), regularity.weights(), seen.period);
        let more = neighbors + self.visit_prior(in_view, period) + self.whole_stays(regular);
        let exposure = in_view + more + prior;
        let observations = Observations { exposure, gaps: &self.histogram, period, regular };
        let fit = observations.fit(self.weights().step.unwrap_or_else(|| slowest(seen)))?;
        Some(GapWeights {
            worth: fit.worth + more,
            neighbors,
            own: in_view + fit.worth,
            mixed: fit.mixed,
            step: Some(fit.step),
        })
    }

    /// The number of steps without an event that gives the prior the weight of one visit: the harmonic mean of the time
    /// between two observations. The rate of a cell that changes much faster than it was observed cannot be known; the
    /// estimate is then the slowest rate that explains the observations.
    fn visit_prior(&self, in_view: Exposure, period: f64) -> Exposure {
        let steps = in_view.steps[0] + in_view.steps[1];
        let (mut visits, mut pace) = (steps, steps);
        for bin in self.histogram.iter() {
            let count = f64::from(bin.count);
            visits += count;
            pace += count * period / bin.length();
        }
        let visit = visits / pace;
        Exposure::uniform(0.0, if visit > 1.0 && visit.is_finite() { visit - 1.0 } else { 0.0 })
    }

    /// The information in complete stays, in addition to their time in view. Mostly it is the state with the shorter
    /// stays that has complete stays; of the other state, only the shortest stays fit into a visit, and they count
    /// little. `regular`: the regularity of the stays in each state, from 0 (random length) to 1 (equal length).
    fn whole_stays(&self, regular: [f64; 2]) -> Exposure {
        let Some(Weighed { weights: GapWeights { step: Some(step), .. }, whole_stays, .. }) =
            self.weighed.as_deref()
        else {
            return Exposure::default();
        };
        let share = [step.block, step.free].map(|leave| leave / (step.block + step.free));
        whole_stays.scaled([0, 1].map(|state| WHOLE_STAY * (share[state] * share[state] * regular[state])))
    }
}

/// The slowest chain that the observations of a cell allow.
fn slowest(seen: &CellStatistics) -> Step {
    let steps = (seen.last_seen - seen.first_seen) / seen.period + 1.0;
    let leave = (f64::from(seen.events().max(1)) / steps).min(0.5);
    Step { block: leave, free: leave }
}

//! What the gaps in the view of a cell tell: its state before, its state after, and the time between.

mod bins;
mod fit;
mod poisson;
mod prior;
mod regularity;
mod watch;

use crate::chain::Step;
use crate::estimator::Estimator;
use crate::ledger::ReadingIndex;
use crate::{CellStatistics, GapWorth};
use bins::Bins;
use fit::Evidence;
pub(crate) use prior::{MEAN_EVENTS, MEDIAN_EVENTS, Near};
pub(crate) use regularity::Regularity;
pub(crate) use watch::Watch;

/// Gaps are weighed anew when so much more was counted, or watched, than when they last were: the work per
/// gap is bounded, and what is missed tells little.
const COUNTED_GROWTH: f64 = 1.0 / 8.0;
const WATCHED_GROWTH: f64 = 1.0 / 4.0;

/// A stay by the clock that was seen whole counts as so many more stays of a chain: it tells the length of
/// all of them.
const WHOLE_STAY: f64 = 3.0;

/// The gaps of one cell, and what they are worth.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gaps {
    bins: Bins,
    /// Only of a cell that changed.
    weighed: Option<Box<Weighed>>,
}

/// What the gaps were worth when they were last weighed, and when that was.
#[derive(Clone, Debug, Default)]
struct Weighed {
    /// The gaps, the neighbours, the whole stays, and the step of looking.
    worth: Watch,
    /// The neighbours alone.
    near: Watch,
    /// What was watched, and the gaps.
    own: Watch,
    /// What the gaps tell of both probabilities together.
    mixed: f64,
    /// The maximum, to start the next search from.
    step: Option<Step>,
    /// Gaps and events, and the time watched, when the gaps are weighed next.
    due: [f64; 2],
    /// The last stay in each state from an event in view to an event in view, in steps; 0 before the first.
    stays: [f64; 2],
    /// All such stays: how many, and their steps.
    whole: Watch,
}

/// What is believed of both probabilities of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Belief {
    /// The watching that would tell as much.
    pub(crate) watch: Watch,
    /// What the gaps tell of both together: the mixed term of their information, in log-odds.
    pub(crate) mixed: f64,
}

impl Gaps {
    /// Adds a gap between two readings, `length` long, with whether the cell was blocked before and after.
    pub(crate) fn add(&mut self, between: [ReadingIndex; 2], length: f64, blocked: [bool; 2]) {
        self.bins.add(between, length, blocked);
    }

    /// The cell has been in another state, `after`, since the reading `since`: if that lies before the end of
    /// the last gap, the gap was not what it looked like.
    pub(crate) fn correct_last(&mut self, since: ReadingIndex, after: bool) {
        self.bins.correct_last(since, after);
    }

    /// The cell stayed in a state for so many steps, from an event in view to an event in view.
    pub(crate) fn add_stay(&mut self, state: usize, steps: f64, regularity: &mut Regularity) {
        let weighed = self.weighed.get_or_insert_default();
        weighed.whole.events[state] += 1.0;
        weighed.whole.steps[state] += steps;
        let before = std::mem::replace(&mut weighed.stays[state], steps);
        if before > 0.0 {
            regularity.add(state, before, steps);
        }
    }

    /// What was watched of the cell, with what its gaps are worth, when they were last weighed.
    pub(crate) fn own(&self) -> Watch {
        self.weighed.as_ref().map_or(Watch::default(), |weighed| weighed.own)
    }

    /// What the gaps are worth as watching, with steps of `period`.
    pub(crate) fn worth(&self, period: f64) -> GapWorth {
        self.weighed.as_ref().map_or(GapWorth::default(), |weighed| {
            let Watch { events: [block_events, free_events], steps: [free, blocked] } = weighed.worth;
            GapWorth {
                watched_free: free * period,
                watched_blocked: blocked * period,
                block_events,
                free_events,
            }
        })
    }

    /// Whether the gaps of a cell that changes are to be weighed again.
    pub(crate) fn is_due(&self, seen: &CellStatistics) -> bool {
        let due = self.weighed.as_ref().map_or([0.0; 2], |weighed| weighed.due);
        seen.period > 0.0 && (self.counted(seen) >= due[0] || seen.observed() >= due[1])
    }

    fn counted(&self, seen: &CellStatistics) -> f64 {
        f64::from(self.bins.count()) + f64::from(seen.events())
    }

    /// Weighs the gaps of a cell that changes. `near` is what the cells around it tell.
    pub(crate) fn weigh(
        &mut self,
        estimator: Estimator,
        seen: &CellStatistics,
        near: Watch,
        regularity: &Regularity,
    ) {
        let counted = self.counted(seen) * (1.0 + COUNTED_GROWTH) + 0.5;
        let weighed = self.weighed.get_or_insert_default();
        weighed.due = [counted, seen.observed() * (1.0 + WATCHED_GROWTH)];
        if estimator == Estimator::ChoGarciaMolina {
            weighed.worth =
                Watch { events: [poisson::hidden_changes(&self.bins, seen), 0.0], ..Watch::default() };
            return;
        }
        let watch = Watch::of(seen);
        let prior = near
            + prior::of_looking(watch, &self.bins, seen.period)
            + weighed.whole_stays(regularity.weights());
        let evidence = Evidence {
            watch: watch + prior + Watch::of_both(MEDIAN_EVENTS, 1.0),
            gaps: &self.bins,
            period: seen.period,
            regular: regularity.weights(),
        };
        let Some(fit) = evidence.fit(weighed.step.unwrap_or_else(|| slowest(seen))) else { return };
        weighed.step = Some(fit.step);
        weighed.mixed = fit.mixed;
        weighed.own = watch + fit.worth;
        weighed.worth = fit.worth + prior;
        weighed.near = near;
    }

    /// What is believed of a cell with `watch` seen and known besides the gaps; also of one that never changed.
    pub(crate) fn belief(&self, seen: &CellStatistics, watch: Watch, regularity: &Regularity) -> Belief {
        if let Some(Weighed { worth, near, mixed, .. }) = self.weighed.as_deref() {
            let all = watch + *worth;
            // What moves shows itself to all cells around at the same time: they tell of the rate what
            // the cell has mostly seen itself. They move the estimate, but make it no surer.
            let own = [0, 1].map(|state| 1.0 - near.steps[state] / all.steps[state]);
            return Belief { watch: all.times(own), mixed: *mixed };
        }
        let looking = prior::of_looking(Watch::of(seen), &self.bins, seen.period);
        let evidence = Evidence {
            watch: watch + looking,
            gaps: &self.bins,
            period: seen.period,
            regular: regularity.weights(),
        };
        let (worth, mixed) =
            evidence.fit(slowest(seen)).map_or((Watch::default(), 0.0), |fit| (fit.worth, fit.mixed));
        Belief { watch: watch + looking + worth, mixed }
    }
}

impl Weighed {
    /// What the stays that were seen whole tell beyond what was watched. Mostly the state that is left sooner
    /// has such stays; of the other, only its shortest stays fit into a visit, and count little.
    fn whole_stays(&self, regular: [f64; 2]) -> Watch {
        let Some(Step { block, free }) = self.step else { return Watch::default() };
        let [blocked, unblocked] = [block, free].map(|leave| leave / (block + free));
        let part = [blocked * blocked * regular[0], unblocked * unblocked * regular[1]];
        self.whole.times(part.map(|part| WHOLE_STAY * part))
    }
}

/// A chain as slow as what was seen of a cell allows.
fn slowest(seen: &CellStatistics) -> Step {
    let steps = (seen.last_seen - seen.first_seen) / seen.period + 1.0;
    let leave = (f64::from(seen.events().max(1)) / steps).min(0.5);
    Step { block: leave, free: leave }
}

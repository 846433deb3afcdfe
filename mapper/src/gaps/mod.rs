//! What the gaps in the view of a cell tell: its state before, its state after, and the time between.

mod fit;
mod poisson;
mod prior;
pub(crate) mod regularity;
mod table;
pub(crate) mod tune;

use crate::chain::Step;
use crate::estimator::{self, Estimator};
use crate::ledger::ReadingIndex;
use crate::{CellStatistics, GapWorth};
use fit::Evidence;
pub(crate) use fit::Watch;
pub(crate) use regularity::Regularity;
use regularity::Stays;
use table::Bins;

/// Gaps are weighed anew when a cell was seen so much longer, or so much more happened, than when they
/// last were. The work per gap is bounded for it, and what is missed is no more than the next gap tells.
const GROWTH: f64 = 1.0 / 16.0;

/// The gaps of one cell, and what they are worth.
#[derive(Clone, Debug, Default)]
pub(crate) struct GapTable {
    bins: Bins,
    stays: [Stays; 2],
    worth: Watch,
    /// What was watched, with what the gaps are worth, when they were last weighed.
    own: Watch,
    mixed: f64,
    /// The step when the gaps were last weighed, to start from.
    step: Option<Step>,
    /// Gaps and events, and time watched, when the gaps are weighed next.
    due: [f64; 2],
}

impl GapTable {
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
        regularity.add(&mut self.stays[state], state, steps);
    }

    /// What was watched, with what the gaps are worth, when they were last weighed.
    pub(crate) fn own(&self) -> Watch {
        self.own
    }

    /// What the gaps are worth as watching, when they were last weighed.
    pub(crate) fn worth(&self, period: f64) -> GapWorth {
        GapWorth {
            watched_free: self.worth.steps[0] * period,
            watched_blocked: self.worth.steps[1] * period,
            block_events: self.worth.events[0],
            free_events: self.worth.events[1],
        }
    }

    /// Whether the gaps of a cell that changes are to be weighed again.
    pub(crate) fn is_due(&self, seen: &CellStatistics) -> bool {
        let counted = f64::from(self.bins.count() + seen.events());
        seen.period > 0.0 && (counted >= self.due[0] || seen.observed() >= self.due[1])
    }

    /// Weighs the gaps of a cell that changes. `near` is what was seen of the cells around it.
    pub(crate) fn weigh(
        &mut self,
        estimator: Estimator,
        seen: &CellStatistics,
        near: Watch,
        regularity: &Regularity,
    ) {
        let counted = f64::from(self.bins.count() + seen.events());
        self.due = [counted * (1.0 + GROWTH) + 0.5, seen.observed() * (1.0 + 4.0 * GROWTH)];
        match estimator {
            Estimator::ChoGarciaMolina => {
                let changes = estimator::changes_in_view(seen);
                let hidden = poisson::expected_changes(&self.bins, changes, seen.observed());
                self.worth = Watch { events: [hidden, 0.0], ..Watch::default() };
            }
            _ => self.fit(seen, near, regularity),
        }
    }

    fn fit(&mut self, seen: &CellStatistics, near: Watch, regularity: &Regularity) {
        let watch = estimator::watch(seen);
        let prior = prior::of_neighbours(self.own, near);
        let start = self.step.unwrap_or_else(|| {
            // As slow as what was seen allows.
            let time = (seen.last_seen - seen.first_seen) / seen.period + 1.0;
            let leave = (f64::from(seen.events()) / time).min(0.5);
            Step { block: leave, free: leave }
        });
        let evidence = Evidence {
            watch: watch + prior + estimator::gap_prior(),
            gaps: &self.bins,
            period: seen.period,
            regular: regularity.weights(),
        };
        let fit = evidence.fit(start);
        let figures = [fit.worth.steps, fit.worth.events, [fit.mixed, 0.0]];
        if !figures.iter().flatten().all(|figure| figure.is_finite()) {
            return;
        }
        self.step = Some(fit.step);
        self.mixed = fit.mixed;
        self.own = watch + fit.worth;
        self.worth = fit.worth + prior;
    }
}

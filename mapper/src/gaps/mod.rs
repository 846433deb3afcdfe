//! What the gaps in the view of a cell tell: its state before, its state after, and the time between.

mod fit;
mod poisson;
mod table;

use crate::chain::Step;
use crate::estimator::{self, Estimator};
use crate::ledger::ReadingIndex;
use crate::{CellStatistics, GapWorth};
pub(crate) use fit::{Prior, Watch};
use table::Bins;

/// Gaps are weighed anew when a cell was seen so much longer, or so much more happened, than when they
/// last were. The work per gap is bounded for it, and what is missed is no more than the next gap tells.
const GROWTH: f64 = 1.0 / 16.0;

/// The gaps of one cell, and what they are worth.
#[derive(Clone, Debug, Default)]
pub(crate) struct GapTable {
    bins: Bins,
    worth: GapWorth,
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

    /// What the gaps are worth as watching, when they were last weighed.
    pub(crate) fn worth(&self) -> GapWorth {
        self.worth
    }

    /// Weighs the gaps of a cell that changes, if that is due.
    pub(crate) fn weigh(&mut self, estimator: Estimator, seen: &CellStatistics) {
        let counted = f64::from(self.bins.count() + seen.events());
        let watched = seen.observed();
        let is_due = counted >= self.due[0] || watched >= self.due[1];
        if self.bins.count() == 0 || !is_due || !(seen.period > 0.0) {
            return;
        }
        self.due = [counted * (1.0 + GROWTH) + 0.5, watched * (1.0 + 4.0 * GROWTH)];
        match estimator {
            Estimator::ChoGarciaMolina => {
                let changes = estimator::changes_in_view(seen);
                let hidden = poisson::expected_changes(&self.bins, changes, seen.observed());
                self.worth = GapWorth { block_events: hidden, ..GapWorth::default() };
            }
            _ => self.fit(seen),
        }
    }

    fn fit(&mut self, seen: &CellStatistics) {
        let watch = estimator::watch(seen);
        let start = self.step.unwrap_or_else(|| {
            // As slow as what was seen allows.
            let time = (seen.last_seen - seen.first_seen) / seen.period + 1.0;
            let leave = (f64::from(seen.events()) / time).min(0.5);
            Step { block: leave, free: leave }
        });
        let fit = fit::fit(&watch, &self.bins, seen.period, estimator::GAP_PRIOR, start);
        let figures = [fit.worth.steps, fit.worth.events, [fit.mixed, 0.0]];
        if !figures.iter().flatten().all(|figure| figure.is_finite()) {
            return;
        }
        self.step = Some(fit.step);
        self.mixed = fit.mixed;
        self.worth = GapWorth {
            watched_free: fit.worth.steps[0] * seen.period,
            watched_blocked: fit.worth.steps[1] * seen.period,
            block_events: fit.worth.events[0],
            free_events: fit.worth.events[1],
        };
    }
}

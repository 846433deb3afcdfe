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
use table::Bins;

/// Gaps are weighed anew when a cell was seen so much longer, or so much more happened, than when they
/// last were. The work per gap is bounded for it, and what is missed is no more than the next gap tells.
const GROWTH: f64 = 1.0 / 16.0;

/// The gaps of one cell, and what they are worth.
#[derive(Clone, Debug, Default)]
pub(crate) struct GapTable {
    bins: Bins,
    /// The last stay in each state from an event in view to an event in view, in steps; 0 before the first.
    stays: [f64; 2],
    worth: Watch,
    left: ReadingIndex,
    hidden: Watch,
    /// What was watched, with what the gaps are worth, when they were last weighed.
    own: Watch,
    near: Watch,
    mixed: f64,
    /// The step when the gaps were last weighed, to start from.
    step: Option<Step>,
    /// Gaps and events, and time watched, when the gaps are weighed next.
    due: [f64; 2],
}

impl GapTable {
    /// Adds a gap between two readings, `length` long, with whether the cell was blocked before and after.
    pub(crate) fn add(&mut self, between: [ReadingIndex; 2], length: f64, blocked: [bool; 2], rest: f64, _period: f64) {
        if self.left == between[0] + 1 && blocked[0] {
            self.hidden.events[1] += 1.0;
            self.hidden.steps[1] += 1.0;
            self.bins.add([between[0] + 1, between[1]], rest, [false, blocked[1]]);
            return;
        }
        self.bins.add(between, length, blocked);
    }

    /// it left
    pub(crate) fn left(&mut self, now: ReadingIndex) { self.left = now; }

    /// was hidden by what stood next to it from a reading to a reading
    pub(crate) fn unhide(&mut self, from: ReadingIndex, now: ReadingIndex, period: f64) {
        let Some((length, blocked)) = self.bins.take_last(from, now) else { return };
        self.hidden.steps[0] += length / period;
        if blocked { self.hidden.events[0] += 1.0; }
    }

    /// The cell has been in another state, `after`, since the reading `since`: if that lies before the end of
    /// the last gap, the gap was not what it looked like.
    pub(crate) fn correct_last(&mut self, since: ReadingIndex, after: bool) {
        self.bins.correct_last(since, after);
    }

    /// The cell stayed in a state for so many steps, from an event in view to an event in view.
    pub(crate) fn add_stay(&mut self, state: usize, steps: f64, regularity: &mut Regularity) {
        let before = std::mem::replace(&mut self.stays[state], steps);
        if before > 0.0 {
            regularity.add(state, before, steps);
        }
    }

    /// What was watched, with what the gaps are worth, when they were last weighed.
    pub(crate) fn own(&self) -> Watch {
        if *tune::DIFFUSE > 0.0 { return self.own + Watch { events: self.near.events.map(|e| e * *tune::DIFFUSE), steps: self.near.steps.map(|e| e * *tune::DIFFUSE) }; }
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
        let watch = estimator::watch(seen) + self.hidden;
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
        self.near = prior;
        self.worth = fit.worth + prior + self.hidden;
    }
}

//! What is read of a cell, and of all together.

use super::record::place;
use super::{Ledger, PRIOR, ReadingIndex};
use crate::chain::Chain;
use crate::gaps::{Belief, MEAN_EVENTS, Watch};
use crate::{CellStatistics, GapWorth, credible};
use interfaces::CellState;

impl Ledger {
    #[inline]
    pub(crate) fn last_seen(&self, index: usize) -> f64 {
        self.times[self.last(index) as usize]
    }

    pub(crate) fn ever_seen(&self, index: usize) -> bool {
        self.last(index) != super::NEVER
    }

    /// The places of the cells that ever changed, in the order of their first change.
    pub(crate) fn changed(&self) -> impl Iterator<Item = usize> {
        self.survival.cells().iter().map(|&index| index as usize)
    }

    /// The mean time from one reading to the next, up to one of them; 0 before the second.
    pub(super) fn period(&self, until: ReadingIndex) -> f64 {
        let first = PRIOR + 1;
        if until <= first {
            return 0.0;
        }
        (self.times[until as usize] - self.times[first as usize]) / f64::from(until - first)
    }

    pub(crate) fn statistics(&self, index: usize) -> CellStatistics {
        let record = &self.records[index];
        if !record.is_known() {
            return CellStatistics::default();
        }
        let last = self.last(index);
        let (first_seen, last_seen) = (self.times[record.first as usize], self.times[last as usize]);
        let mut watched = record.watched;
        watched[place(self.state(index))] += last_seen - self.times[record.since as usize];
        let [watched_free, watched_blocked] = watched;
        let period = self.period(last);
        CellStatistics {
            first_seen,
            last_seen,
            period,
            unobserved: (last_seen - first_seen - watched_free - watched_blocked).max(0.0),
            watched_free,
            watched_blocked,
            block_events: record.in_view[0],
            free_events: record.in_view[1],
            block_events_after_gap: record.after_gap[0],
            free_events_after_gap: record.after_gap[1],
            gaps_from_free: record.gaps[0],
            gaps_from_blocked: record.gaps[1],
            gap_worth: self.gaps.get(index).map_or(GapWorth::default(), |gaps| gaps.worth(period)),
        }
    }

    /// The two-state chain of the cell, if it has a rate.
    pub(crate) fn chain(&self, index: usize) -> Option<Chain> {
        self.estimator.chain(&self.statistics(index))
    }

    /// The interval that holds the cell's cycle rate with probability `mass`.
    pub(crate) fn credible_interval(&self, index: usize, mass: f64) -> (f64, f64) {
        let mut seen = self.statistics(index);
        seen.period = self.period(self.now_index());
        if seen.period <= 0.0 {
            return (0.0, f64::INFINITY);
        }
        let watch = Watch::of(&seen) + Watch::of_both(MEAN_EVENTS, 1.0);
        let weighed = self.gaps.get(index).filter(|_| self.estimator.fits_chain());
        let belief =
            weighed.map_or(Belief { watch, mixed: 0.0 }, |gaps| gaps.belief(&seen, watch, &self.regularity));
        credible::interval(belief, seen.period, mass)
    }

    /// The probability that the cell is blocked now.
    pub(crate) fn blocked_probability(&self, index: usize) -> f64 {
        let state = self.state(index);
        let is_certain = self.was_seen_now(index) && state != CellState::Unknown;
        match self.chain(index).filter(|_| !is_certain) {
            Some(chain) => chain.blocked_probability(state, self.now() - self.last_seen(index)),
            None => match state {
                CellState::Unknown => 0.5,
                CellState::Free => 0.0,
                CellState::Blocked => 1.0,
            },
        }
    }

    /// The feature r of section 4: the longest time since a candidate was seen.
    pub(crate) fn max_recency(&mut self) -> f64 {
        self.recency.longest().map_or(0.0, |reading| self.now() - self.times[reading as usize])
    }

    /// The feature p of section 4: the expected number of cells that changed since they were
    /// seen. Costs time in proportion to the cells that ever changed.
    pub(crate) fn sum_change_probability(&mut self) -> f64 {
        let mut survival = std::mem::take(&mut self.survival);
        let sum = survival.sum_changed(self.now(), |index| {
            let is_out_of_view = !self.was_seen_now(index);
            is_out_of_view.then(|| (self.last_seen(index), self.estimator.rate(&self.statistics(index))))
        });
        self.survival = survival;
        sum
    }
}

//! The prior that all traversable cells share, kept up to date by a sweep over the map that takes many readings.

use super::CellMap;
use crate::change::RateDistribution;
use crate::change::shared_prior::CycleCounts;
use interfaces::CellState;

/// A sweep over the map takes this share of the readings so far, and at least this many readings: the work per reading is
/// small, and the prior is about as old.
const SWEEP_SHARE: usize = 8;
const SWEEP_READINGS: usize = 8;

/// The prior, and the sweep that renews it.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(super) struct SharedPrior {
    pub(super) prior: Option<RateDistribution>,
    counts: CycleCounts,
    /// The next cell, and the number of readings that this sweep takes and has taken.
    next: usize,
    readings: usize,
    taken: usize,
    /// Whether the open reading found another prior.
    is_new: bool,
}

impl Default for SharedPrior {
    fn default() -> Self {
        Self {
            prior: None,
            counts: CycleCounts::default(),
            next: 0,
            readings: SWEEP_READINGS,
            taken: 0,
            is_new: false,
        }
    }
}

impl CellMap {
    /// Whether the cell is free, or ever changed: things move through these cells, and no other cell has a rate.
    #[inline]
    fn is_traversable(&self, index: usize) -> bool {
        self.state(index) == CellState::Free || self.has_changed(index)
    }

    /// Whether the cell can have a rate: it ever changed, or it is traversable and traversable cells share a prior.
    #[inline]
    pub(crate) fn has_rate(&self, index: usize) -> bool {
        self.has_changed(index) || self.shared.is_some() && self.is_traversable(index)
    }

    /// The posterior of the rate of a traversable cell, if cells share a prior; `None` before the first prior.
    pub(crate) fn rate_posterior(&self, index: usize) -> Option<RateDistribution> {
        let is_traversable = self.shared.is_some() && self.is_traversable(index);
        is_traversable.then(|| self.statistics(index).posterior()).flatten()
    }

    /// Whether the open reading found another prior: the rates of cells out of view are others then.
    pub(crate) fn has_new_prior(&self) -> bool {
        self.shared.as_ref().is_some_and(|shared| shared.is_new)
    }

    /// Goes on with the sweep over the map: a part of the cells per reading.
    pub(super) fn sweep(&mut self) {
        let Some(mut shared) = self.shared.take() else { return };
        let cells = self.records.len();
        let end = cells.min(shared.next + cells.div_ceil(shared.readings));
        for index in (shared.next..end).filter(|&index| self.is_traversable(index)) {
            let seen = self.statistics(index);
            shared.counts.add(seen.cycles(), seen.observed());
        }
        shared.next = end;
        shared.taken += 1;
        // A small map is swept at once, but its prior does not change with every reading.
        shared.is_new = end == cells && 2 * shared.taken >= shared.readings;
        if shared.is_new {
            shared.prior = shared.counts.fit().or(shared.prior);
            shared.counts = CycleCounts::default();
            (shared.next, shared.taken) = (0, 0);
            shared.readings = (self.readings() / SWEEP_SHARE).max(SWEEP_READINGS);
        }
        self.shared = Some(shared);
    }
}

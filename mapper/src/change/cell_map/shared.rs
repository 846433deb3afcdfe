//! The prior that traversable cells share, learned anew now and then.

use super::CellMap;
use crate::change::RateDistribution;
use crate::change::shared_prior::{InView, Learned, RatePrior};
use interfaces::{CellState, GridFrame, Place, SparseCells};

/// The prior is learned anew after a quarter more readings, from this many readings on and after at most this many: one
/// minute at 10 Hz.
const RENEWAL_READINGS: [usize; 2] = [8, 600];

/// The prior, and when it is learned anew.
#[derive(Clone, Debug)]
pub(super) struct SharedPrior {
    pub(super) prior: Option<RatePrior>,
    /// The mean rate of each cell; 0 for a cell that was not traversable when the prior was learned.
    pub(super) means: SparseCells<f32>,
    /// The number of readings at which the prior is learned anew.
    pub(super) due: usize,
}

impl SharedPrior {
    pub(super) fn new(frame: &GridFrame) -> Self {
        Self { prior: None, means: SparseCells::in_blocks(frame.width(), frame.height(), 0.0), due: 0 }
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

    /// The prior of the rate of a cell, once there is one.
    pub(super) fn rate_prior(&self, place: Place) -> Option<RateDistribution> {
        let shared = self.shared.as_ref()?;
        Some(shared.prior?.with_mean(*shared.means.at_place(place)))
    }

    /// Learns the prior anew if it is time.
    pub(super) fn renew_prior(&mut self) {
        let Some(mut shared) = self.shared.take() else { return };
        let readings = self.readings();
        if readings >= shared.due {
            let [least, most] = RENEWAL_READINGS;
            shared.due = readings + (readings / 4).clamp(least, most);
            if let Some(Learned { prior, cells, means }) = RatePrior::learned(self.frame(), self.in_view()) {
                shared.prior = Some(prior);
                shared.means.stored_values_mut().for_each(|mean| *mean = 0.0);
                cells.iter().zip(means).for_each(|(index, mean)| shared.means[*index as usize] = mean);
            }
        }
        self.shared = Some(shared);
    }

    /// What was in view of every traversable cell.
    fn in_view(&self) -> InView {
        let known = self.states.cells().other_than(CellState::Unknown).map(|(index, _)| index);
        let mut seen = InView::default();
        for index in known.filter(|index| self.is_traversable(*index)) {
            let record = self.records.get(index);
            let open = self.last_seen(index) - self.times.at(record.since);
            seen.cells.push(index as u32);
            seen.cycles.push(record.in_view[0].max(record.in_view[1]) as f32);
            seen.times.push((record.watched.iter().sum::<f64>() + open) as f32);
        }
        seen
    }
}

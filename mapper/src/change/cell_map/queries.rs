use super::record::state_index;
use super::{CellMap, PRIOR, Slot};
use crate::change::gaps::MEAN_EVENTS;
use crate::change::{Belief, CellStatistics, Evidence, Exposure, ReadingIndex, TransitionRates};
use interfaces::{CellState, Grid, GridFrame};

impl CellMap {
    /// The position and the size of the map.
    pub fn frame(&self) -> &GridFrame {
        self.states.frame()
    }

    /// The states of all cells.
    pub fn states(&self) -> &Grid<CellState> {
        &self.states
    }

    /// The state of a cell.
    #[inline]
    pub fn state(&self, index: usize) -> CellState {
        self.states.cells()[index]
    }

    /// The memory of the cells, bytes; what the gaps of cells that changed own is estimated.
    pub(crate) fn bytes(&self) -> usize {
        self.states.cells().bytes()
            + self.observed.bytes()
            + self.records.bytes()
            + self.gaps.bytes()
            + self.gap_bytes
            + self.flags.bytes()
            + self.shared.as_ref().map_or(0, |shared| shared.means.bytes())
    }

    /// The number of the open reading.
    #[inline]
    pub fn reading(&self) -> ReadingIndex {
        self.times.last()
    }

    /// The mean time between consecutive readings, s; 0 before the second one.
    pub(crate) fn period(&self) -> f64 {
        self.times.period(self.reading())
    }

    /// The time of the open reading.
    #[inline]
    pub fn time(&self) -> f64 {
        self.times.at(self.times.last())
    }

    /// The time of a reading, which is about that if it was forgotten.
    pub(crate) fn time_of(&self, reading: ReadingIndex) -> f64 {
        self.times.at(reading)
    }

    /// The index of a cell among those that ever changed.
    pub(crate) fn slot(&self, index: usize) -> Option<Slot> {
        self.records.get(index).slot
    }

    /// The number of readings so far.
    pub(crate) fn readings(&self) -> usize {
        (self.reading() - PRIOR) as usize
    }

    #[inline]
    pub(crate) fn last_seen(&self, index: usize) -> f64 {
        self.times.at(self.last_reading(index))
    }

    /// The time from the first observation of a cell to the last one; 0 for a cell that was never observed.
    pub(crate) fn known_for(&self, index: usize) -> f64 {
        let record = self.records.at(self.records.place(index));
        if record.is_known() { self.last_seen(index) - self.times.at(record.first) } else { 0.0 }
    }

    pub(crate) fn was_ever_seen(&self, index: usize) -> bool {
        self.last_reading(index) != super::NEVER
    }

    /// The cells that a reading ever observed, by ascending index.
    pub(crate) fn seen(&self) -> impl Iterator<Item = usize> {
        let stored = self.observed.stored();
        stored
            .filter(|(_, last)| **last & !super::observing::UNSETTLED != super::NEVER)
            .map(|(index, _)| index)
    }

    /// The time of the last observation of the candidate that has not been observed for longest.
    pub(crate) fn oldest_candidate(&mut self) -> Option<f64> {
        self.last_seen_counts.oldest().map(|reading| self.times.at(reading))
    }

    /// The change statistics of a cell.
    pub fn statistics(&self, index: usize) -> CellStatistics {
        let place = self.records.place(index);
        let record = self.records.at(place);
        if !record.is_known() {
            return CellStatistics::default();
        }
        // The lists that every reading reads have no blocks in a small map.
        let dense = if self.observed.is_small() { self.observed.place(index) } else { place };
        let last = self.observed.at_place(dense) & !super::observing::UNSETTLED;
        let (first_seen, last_seen) = (self.times.at(record.first), self.times.at(last));
        let mut watched = record.watched;
        watched[state_index(*self.states.cells().at_place(dense))] += last_seen - self.times.at(record.since);
        let [watched_free, watched_blocked] = watched;
        let period = self.times.period(last);
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
            gap_worth: self.gaps.at(place).worth(period),
            prior: self.rate_prior(place),
        }
    }

    /// The evidence of a cell that changed about its rates.
    pub(crate) fn evidence(&self, index: usize) -> Evidence {
        let seen = self.statistics(index);
        let events = [seen.block_events, seen.free_events];
        let gaps = self.gaps[index].histogram.clone();
        Evidence::of_cell([seen.watched_free, seen.watched_blocked], events, gaps)
    }

    /// How often the state of the cell changed in the map: its changes, and the correction of a wrong first observation.
    pub(crate) fn map_changes(&self, index: usize) -> u32 {
        self.statistics(index).events() + u32::from(self.records.get(index).was_corrected)
    }

    /// Whether the cell ever changed. Most cells did not: their rates need no statistics.
    #[inline]
    pub(crate) fn has_changed(&self, index: usize) -> bool {
        self.flags[index].has_changed
    }

    /// Whether the cell can be a goal.
    #[inline]
    pub(crate) fn is_candidate(&self, index: usize) -> bool {
        self.flags[index].is_candidate
    }

    /// The cycle rate of a cell with which the robot acts; 0 if the cell never changed.
    #[inline]
    pub(crate) fn acting_rate(&self, index: usize) -> f64 {
        if self.has_changed(index) { self.estimator.acting_rate(&self.statistics(index)) } else { 0.0 }
    }

    /// The transition rates of a cell, if the estimator in use computes them.
    pub(crate) fn transition_rates(&self, index: usize) -> Option<TransitionRates> {
        let seen = self.has_changed(index).then(|| self.statistics(index));
        seen.and_then(|seen| self.estimator.transition_rates(&seen))
    }

    /// For free and for blocked stays, the squared coefficient of variation over the whole map; 1, as in a chain, until
    /// stays were seen, and under an estimator without a model of gaps.
    pub(crate) fn variation(&self) -> [f64; 2] {
        self.regularity.variation()
    }

    /// The belief about the transition probabilities of a cell, and the time of a step; `None` before the second
    /// reading.
    pub(crate) fn belief(&self, index: usize) -> Option<(Belief, f64)> {
        let period = self.times.period(self.reading());
        if period <= 0.0 {
            return None;
        }
        let seen = CellStatistics { period, ..self.statistics(index) };
        let belief = match self.estimator.weighs_gaps() {
            true => self.gaps[index].belief(&seen, &self.regularity),
            false => Belief {
                exposure: Exposure::in_view(&seen) + Exposure::uniform(MEAN_EVENTS, 1.0),
                mixed: 0.0,
            },
        };
        Some((belief, period))
    }
}

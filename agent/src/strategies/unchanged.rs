//! What is assumed of the rate of a cell that never changed.

use interfaces::CellState;
use mapper::Mapper;

/// The number of events that is assumed for a cell that never changed: one half, as in the Jeffreys posterior of a
/// Poisson rate.
const UNSEEN_EVENTS: f64 = 0.5;

/// The rates of cells that never changed: such a cell counts like a cell with half an event in its observation time, times the share
/// of cells that ever changed. Without this share, a robot would stay with the first moving thing.
pub(super) struct UnchangedCells {
    share: f64,
}

impl UnchangedCells {
    /// By the cells of a map that can be goals.
    pub(super) fn of(mapper: &Mapper) -> Self {
        let states = mapper.states().cells();
        let candidates = (0..states.len()).filter(|&cell| mapper.is_candidate(cell));
        let known = candidates.filter(|&cell| states[cell] != CellState::Unknown).count();
        Self { share: (mapper.changed().count() as f64 + UNSEEN_EVENTS) / (known as f64 + 1.0) }
    }

    /// The probability that a cell changes at all, and the rate at which it then leaves either state.
    pub(super) fn rate(&self, mapper: &Mapper, cell: usize) -> (f64, f64) {
        let seen = mapper.statistics(cell);
        let rate = UNSEEN_EVENTS / (seen.watched_free + seen.watched_blocked + 1.0);
        let probability = if seen.events() > 0 { 1.0 } else { self.share.min(1.0) };
        (probability, rate)
    }
}

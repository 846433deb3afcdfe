//! A cell as its tile predicts it.

use super::Tiles;
use crate::change::Slot;
use interfaces::Cell;

/// The share of a cell in its blocked tile is that of all cells of the tile before this number of looks.
const PRIOR_LOOKS: f64 = 30.0;
/// A tile or a door that was seen in this number of half hours counts as much as the chain of the cell. Houses of people without hours
/// (seeds 5000 to 5005) are then predicted as well as by the chains alone, after 20 minutes and after 8 hours.
pub(crate) const HALF_HOURS: f64 = 24.0;

/// What the clock of a tile says of one of its cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ByClock {
    /// The probability that the cell is blocked at a time, and at the last look at the tile, if nothing else is known of it.
    pub(crate) later: f64,
    pub(crate) then: f64,
    /// The weight of the clock against the cell's own statistics.
    pub(crate) weight: f64,
}

impl ByClock {
    /// The probability that the cell is blocked. What its last state differed from that of the tile by fades with its own
    /// memory; `alone` is the probability without the clock.
    pub(crate) fn blocked_probability(self, observed: f64, memory: f64, alone: f64) -> f64 {
        let predicted = (self.later + (observed - self.then) * memory).clamp(0.0, 1.0);
        alone + self.weight * (predicted - alone)
    }
}

impl Tiles {
    /// What the tile of a cell says of it at a time, s; `None` before the first look.
    pub(crate) fn of_cell(&self, cell: Cell, slot: Slot, time_s: f64) -> Option<ByClock> {
        let (tile, of) = (self.at(cell)?, self.learned.cells.get(slot as usize)?);
        let last = tile.last?;
        let share = of.counts.share(tile.counts.share(0.5, 1.0), PRIOR_LOOKS);
        let later = share * tile.clock.probability(self.epoch_s + time_s, self.calendar());
        let half_hours = tile.clock.half_hours();
        let weight = half_hours / (half_hours + HALF_HOURS);
        Some(ByClock { later, then: share * f64::from(u8::from(last.is_blocked)), weight })
    }
}

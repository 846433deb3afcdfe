//! Whether a cell that never changed does so at all, and what watching it is then worth.
//!
//! Most cells never change, so the rate of a cell has a spike at zero: it changes with probability θ
//! before it is watched, and after it showed nothing with probability S (if it changes) still with
//! θ S / (θ S + 1 − θ). The share θ is learned from the cells seen so far (empirical Bayes), and so
//! are the odds of the rates.

use super::rates::{Gains, Odds, RATES, Rates};
use super::things::{Position, Things};
use interfaces::CellState;
use mapper::Mapper;

/// θ far from all that changed, and the number of cells that this is believed as strongly as.
const FAR: [f64; 2] = [0.05, 100.0];
/// The same beside the middle of a thing's way.
const MIDDLE: [f64; 2] = [0.05, 10.0];
/// θ beside the end of a way as far as it is known. Not learned: the cells that changed are those
/// where it was right.
const END: f64 = 0.5;
/// θ of a cell that has been blocked since it was first seen: nearly all of them are walls.
const BLOCKED: f64 = 0.003;

/// An undiscovered thing would have shown itself in any cell of its way, as many as these: silence far
/// from all things counts that often.
const WAY_IN_VIEW: f64 = 5.0;
/// A thing that stands somewhere leaves that cell as many times faster as its way is long.
const WAY: f64 = 10.0;
/// What an unknown cell is worth to one just seen free: more, since there may be others behind it.
const UNKNOWN: f64 = 1.5;
/// The share of cells beside a thing that move at its pace, if they change; the others at any.
const SAME_PACE: f64 = 0.8;
/// The number of cells that all rates are believed as strongly as to be equally likely.
const FLAT: f64 = 2.0;

/// What is believed of cells in general.
#[derive(Clone, Debug)]
pub(super) struct Change {
    far: f64,
    middle: f64,
    /// The odds of the rates of cells that change.
    odds: Odds,
}

/// Sums from which shares are learned.
struct Share([f64; 2]);

impl Share {
    fn new([share, strength]: [f64; 2]) -> Self {
        Self([share * strength, strength])
    }

    fn add(&mut self, chance: f64) {
        self.0[0] += chance;
        self.0[1] += 1.0;
    }

    fn value(&self) -> f64 {
        self.0[0] / self.0[1]
    }
}

impl Change {
    pub(super) fn new() -> Self {
        Self { far: FAR[0], middle: MIDDLE[0], odds: [1.0 / RATES as f64; RATES] }
    }

    /// The odds of the rates of a cell that changes; at the pace of the thing beside it, if there is one.
    pub(super) fn odds(&self, rates: &Rates, pace: Option<f64>) -> Odds {
        let Some(pace) = pace else { return self.odds };
        let around = rates.around(pace);
        std::array::from_fn(|rate| SAME_PACE * around[rate] + (1.0 - SAME_PACE) * self.odds[rate])
    }

    /// Learns how fast cells are from the odds of all that changed.
    pub(super) fn learn_odds<'a>(&mut self, changed: impl Iterator<Item = &'a Odds>) {
        let mut sums = [FLAT / RATES as f64; RATES];
        for odds in changed {
            sums.iter_mut().zip(odds).for_each(|(sum, odds)| *sum += odds);
        }
        let total: f64 = sums.iter().sum();
        self.odds = sums.map(|sum| sum / total);
    }

    /// Gives `take` each cell that never changed and can be worth a look, with the gains of watching it, and
    /// learns how likely such cells are to change. A pass over the map.
    pub(super) fn judge(
        &mut self,
        mapper: &Mapper,
        things: &Things,
        rates: &Rates,
        mut take: impl FnMut(usize, &Gains),
    ) {
        let table: Vec<(f64, Gains)> = (0..Rates::bins()).map(|bin| rates.silent(&self.odds, bin)).collect();
        let (mut far, mut middle) = (Share::new(FAR), Share::new(MIDDLE));
        let frame = mapper.frame();
        for (cell, state) in mapper.states().cells().iter().enumerate() {
            if !mapper.is_candidate(cell) && *state != CellState::Unknown {
                continue; // the inside of a wall
            }
            let (position, pace) = things.position(frame, cell);
            if things.has(cell) {
                far.add(1.0);
                if position == Position::Middle {
                    middle.add(1.0);
                }
                continue;
            }
            let (chance, watched, factor) = match (state, position) {
                (CellState::Unknown, _) => (self.chance(position), 0.0, UNKNOWN),
                (CellState::Free, Position::Far) => {
                    (self.far, WAY_IN_VIEW * since_first_seen(mapper, cell), 1.0)
                }
                (CellState::Free, _) => (self.chance(position), mapper.statistics(cell).watched_free, 1.0),
                (CellState::Blocked, _) => (BLOCKED, WAY * since_first_seen(mapper, cell), 1.0),
            };
            let bin = Rates::bin(watched);
            let (silent, gains) = if pace.is_finite() && *state != CellState::Blocked {
                rates.silent(&self.odds(rates, Some(pace)), bin)
            } else {
                table[bin]
            };
            let evidence = chance * silent + 1.0 - chance;
            take(cell, &gains.map(|gain| factor * chance / evidence * gain));
            if *state == CellState::Free {
                match position {
                    Position::Far => far.add(chance * silent / evidence),
                    Position::Middle => middle.add(chance * silent / evidence),
                    Position::End => {}
                }
            }
        }
        (self.far, self.middle) = (far.value(), middle.value());
    }

    fn chance(&self, position: Position) -> f64 {
        match position {
            Position::Far => self.far,
            Position::Middle => self.middle,
            Position::End => END,
        }
    }
}

/// For how long the cell may have shown nothing: what both looks at the ends of a gap found alike counts as
/// seen.
fn since_first_seen(mapper: &Mapper, cell: usize) -> f64 {
    let seen = mapper.statistics(cell);
    seen.last_seen - seen.first_seen
}

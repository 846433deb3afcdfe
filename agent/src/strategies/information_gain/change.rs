//! The probability that a cell without an observed change changes at all, and the gain of observing the cell.
//!
//! Most cells never change, so the distribution of the rate of a cell has a spike at zero: the cell changes
//! with probability θ before it is observed, and with θ S / (θ S + 1 − θ) after an observation without an event,
//! whose probability is S if the cell changes. The share θ and the distribution of the rates are learned from
//! the cells seen so far (empirical Bayes).

use super::clusters::{Clusters, Position};
use super::rates::{BINS, Distribution, Gains, RATES, Rates, normalized};
use interfaces::{CellState, Values, value};
use mapper::Mapper;

/// θ far from all cells that changed, and the weight of this prior, in cells.
const FAR: [f64; 2] = [0.05, 100.0];
/// θ beside the middle of a cluster, and the weight of this prior, in cells.
const MIDDLE: [f64; 2] = [0.05, 10.0];
/// θ beside the end of a cluster. θ is not learned here: the cells that changed are those where the assumption was
/// right.
const END: f64 = 0.5;
/// θ of a cell that has been blocked since it was first seen: nearly all such cells are walls.
const BLOCKED: f64 = 0.003;

/// The length of the path of a moving thing: the thing leaves its present cell this many times faster than it
/// returns.
const PATH: f64 = 10.0;
/// The value of an unknown cell relative to a free cell. The value is above 1, since further unknown cells may be
/// behind it.
const UNKNOWN: f64 = 1.5;
/// The share of the cells beside a cluster that change at the rate of the cluster, if they change; the rate of the
/// others is arbitrary.
const SAME_RATE: f64 = 0.8;
/// The weight of the uniform distribution of the rates, in cells.
const FLAT: f64 = 2.0;

/// What was learned about all cells together.
#[derive(Clone, Debug)]
pub(super) struct Change {
    far: f64,
    middle: f64,
    /// The distribution of the rates of the cells that change.
    distribution: Distribution,
}

/// A share as a sum of probabilities and the number of its cells.
fn add([sum, cells]: &mut [f64; 2], probability: f64) {
    *sum += probability;
    *cells += 1.0;
}

impl Change {
    pub(super) fn new() -> Self {
        Self { far: FAR[0], middle: MIDDLE[0], distribution: [1.0 / RATES as f64; RATES] }
    }

    /// The distribution of the rates of a cell that changes, given the rate of the cluster beside it.
    fn distribution(&self, rates: &Rates, cluster_rate: f64) -> Distribution {
        let around = rates.around(cluster_rate);
        std::array::from_fn(|rate| SAME_RATE * around[rate] + (1.0 - SAME_RATE) * self.distribution[rate])
    }

    /// What was learned; the distribution of the rates is learned anew for every goal.
    pub(super) fn values(&mut self) -> Values<'_> {
        vec![value(&mut self.far), value(&mut self.middle)]
    }

    /// Learns the distribution of the rates from the number of changed cells with each rate.
    pub(super) fn learn_rates(&mut self, cells: [u32; RATES]) {
        self.distribution = normalized(cells.map(|cells| f64::from(cells) + FLAT / RATES as f64));
    }

    /// Calls `take` with each cell that never changed and can be worth a visit, and with the gains of observing it. An
    /// observation without an event counts `path_in_view` times far from all clusters.
    /// Learns how likely such cells are to change. One pass over the map.
    pub(super) fn gains_of_unchanged(
        &mut self,
        mapper: &Mapper,
        clusters: &Clusters,
        rates: &Rates,
        path_in_view: f64,
        mut take: impl FnMut(usize, &Gains),
    ) {
        let table: Vec<(f64, Gains)> = (0..BINS).map(|bin| rates.silent(&self.distribution, bin)).collect();
        let [mut far, mut middle] = [FAR, MIDDLE].map(|[share, cells]| [share * cells, cells]);
        let frame = mapper.frame();
        for (cell, state) in mapper.states().cells().iter().enumerate() {
            if !mapper.is_candidate(cell) && *state != CellState::Unknown {
                continue; // the inside of a wall
            }
            let (position, cluster_rate) = clusters.position(frame, cell);
            if clusters.has(cell) {
                add(&mut far, 1.0);
                if position == Position::Middle {
                    add(&mut middle, 1.0);
                }
                continue;
            }
            let (probability, watched, factor) = match (state, position) {
                (CellState::Unknown, _) => (self.probability(position), 0.0, UNKNOWN),
                (CellState::Free, Position::Far) => {
                    (self.far, path_in_view * mapper.statistics(cell).watched_free, 1.0)
                }
                (CellState::Free, _) => {
                    (self.probability(position), mapper.statistics(cell).watched_free, 1.0)
                }
                (CellState::Blocked, _) => (BLOCKED, PATH * since_first_seen(mapper, cell), 1.0),
            };
            let bin = Rates::bin(watched);
            let (silent, gains) = if cluster_rate.is_finite() && *state != CellState::Blocked {
                rates.silent(&self.distribution(rates, cluster_rate), bin)
            } else {
                table[bin]
            };
            let evidence = probability * silent + 1.0 - probability;
            take(cell, &gains.map(|gain| factor * probability / evidence * gain));
            if *state == CellState::Free {
                match position {
                    Position::Far => add(&mut far, probability * silent / evidence),
                    Position::Middle => add(&mut middle, probability * silent / evidence),
                    Position::End => {}
                }
            }
        }
        (self.far, self.middle) = (far[0] / far[1], middle[0] / middle[1]);
    }

    fn probability(&self, position: Position) -> f64 {
        match position {
            Position::Far => self.far,
            Position::Middle => self.middle,
            Position::End => END,
        }
    }
}

/// The time in which the cell showed no event. A gap with the same state at both ends counts as seen.
fn since_first_seen(mapper: &Mapper, cell: usize) -> f64 {
    let seen = mapper.statistics(cell);
    seen.last_seen - seen.first_seen
}

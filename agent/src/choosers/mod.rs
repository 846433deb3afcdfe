mod curious;
mod tile_coder;

pub use curious::Curious;

use crate::situation::{Features, Situation};
use interfaces::{RandomStream, Values};
use rand::RngExt;

/// The result of one goal: the data from which a chooser learns.
#[derive(Clone, Copy, Debug)]
pub struct Trajectory<'a> {
    /// The index of the strategy that selected the goal.
    pub strategy: usize,
    /// The features after each reading; at least one reading. T of section 4.
    pub features: &'a [Features],
    /// The number of map updates per reading, R of section 4; finite, 0 or more.
    pub reward: f64,
}

/// Selects the strategy that selects the next goal. A strategy is identified by its index in the agent's list.
pub trait Chooser: std::fmt::Debug + Send {
    /// The index of the strategy for the next goal.
    fn choose(&mut self, situation: &Situation, rng: &mut RandomStream) -> usize;

    /// Learns from the result of the last choice. Does nothing by default.
    fn learn(&mut self, _: &Trajectory) {}

    /// The expected reward per reading of the strategy at `features` (map updates); `None` if the
    /// chooser has no values.
    fn value(&self, _strategy: usize, _features: Features) -> Option<f64> {
        None
    }

    /// Everything that was learned: what a state file holds of the chooser. Empty for a chooser that learns nothing.
    fn values(&mut self) -> Values<'_> {
        Vec::new()
    }
}

/// Always chooses the strategy with this index.
#[derive(Clone, Copy, Debug)]
pub struct Always(pub usize);

impl Chooser for Always {
    fn choose(&mut self, _: &Situation, _: &mut RandomStream) -> usize {
        self.0
    }
}

/// Chooses among this number of strategies at random, all with the same probability: the baseline for learners.
#[derive(Clone, Copy, Debug)]
pub struct Coin(pub std::num::NonZeroUsize);

impl Chooser for Coin {
    fn choose(&mut self, _: &Situation, rng: &mut RandomStream) -> usize {
        rng.random_range(0..self.0.get())
    }
}

mod always;
mod coin;
mod curious;
mod progress;
mod tile_coder;

pub use always::Always;
pub use coin::Coin;
pub use curious::Curious;
pub use progress::Progress;
pub use tile_coder::TileCoder;

use crate::features::Features;
use crate::situation::Situation;
use interfaces::{RandomStream, Values};

/// The result of one goal: the data from which a chooser learns.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Trajectory<'a> {
    /// The index of the strategy that selected the goal.
    pub strategy: usize,
    /// The features after each reading; at least one reading. T of section 4.
    pub features: &'a [Features],
    /// The number of map updates per reading, R of section 4; finite, 0 or more.
    pub reward: f64,
    /// The progress in learning per reading: the expected decrease of the error of the logarithms of the rates,
    /// summed over the cells. Finite, 0 or more.
    pub progress: f64,
}

/// Selects the strategy that selects the next goal. A strategy is identified by its index in the agent's list.
pub trait Chooser: std::fmt::Debug + Send {
    /// The index of the strategy for the next goal.
    fn choose(&mut self, situation: &Situation, rng: &mut RandomStream) -> usize;

    /// Learns from the result of the last choice. Does nothing by default.
    fn learn(&mut self, _: &Trajectory) {}

    /// The expected reward per reading of the strategy at `features` (map updates, or progress); `None` if the
    /// chooser has no values.
    fn value(&self, _strategy: usize, _features: Features) -> Option<f64> {
        None
    }

    /// Everything that was learned: what a state file holds of the chooser. Empty for a chooser that learns nothing.
    fn values(&mut self) -> Values<'_> {
        Vec::new()
    }
}

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
use interfaces::RandomStream;

/// The result of following a strategy to one goal.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Trajectory<'a> {
    /// The index of the strategy.
    pub strategy: usize,
    /// The features after each reading, at least one; T of section 4.
    pub features: &'a [Features],
    /// Map updates per reading, R of section 4; finite, not negative.
    pub reward: f64,
    /// The progress in learning per reading: the expected fall of the error of the logarithms of the rates of
    /// change, summed over the cells. Finite, not negative.
    pub progress: f64,
}

/// Selects the strategy that samples the next goal. Strategies are given by index in the list of the agent.
pub trait Chooser: std::fmt::Debug + Send {
    /// The index of the next strategy.
    fn choose(&mut self, situation: &Situation, rng: &mut RandomStream) -> usize;

    /// Learns from the result of the last choice.
    fn learn(&mut self, _: &Trajectory) {}

    /// The expected reward per reading of the strategy at `features` (map updates, or progress); `None` from a
    /// chooser without values.
    fn value(&self, _strategy: usize, _features: Features) -> Option<f64> {
        None
    }
}

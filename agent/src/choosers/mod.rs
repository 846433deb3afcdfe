mod always;
mod coin;
mod curious;
mod progress;

pub use always::Always;
pub use coin::Coin;
pub use curious::Curious;
pub use progress::Progress;

use crate::Features;
use crate::Situation;
use interfaces::RandomStream;

/// What came of following a strategy to one goal.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Trajectory<'a> {
    /// The place of the strategy that was followed.
    pub strategy: usize,
    /// The features after each reading, at least one; T of section 4.
    pub features: &'a [Features],
    /// Map updates per reading, R of section 4; finite, not negative.
    pub reward: f64,
    /// How much more is known of the rates of change, per reading: by how much the error of their
    /// logarithms is expected to have fallen, summed over the cells. Finite, not negative.
    pub progress: f64,
}

/// A way to pick the strategy that samples the next goal. Strategies are known by their places in
/// the agent's list.
pub trait Chooser: std::fmt::Debug + Send {
    /// The place of the next strategy.
    fn choose(&mut self, situation: &Situation, rng: &mut RandomStream) -> usize;

    /// Learns from what came of the last choice.
    fn learn(&mut self, _: &Trajectory) {}

    /// What the strategy is believed to bring at `features`, in what it is rewarded for
    /// per reading (map updates, or progress); `None` from a chooser that does not value strategies.
    fn value(&self, _strategy: usize, _features: Features) -> Option<f64> {
        None
    }
}

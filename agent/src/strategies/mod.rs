mod frontier;
mod information_gain;
mod optimal_revisiting;
mod poisson;
mod random;
mod recency;

pub use frontier::Frontier;
pub use information_gain::InformationGain;
pub use optimal_revisiting::OptimalRevisiting;
pub use poisson::Poisson;
pub use random::Random;
pub use recency::Recency;

use crate::situation::Situation;
use interfaces::Cell;

/// How a goal is selected by the weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pick {
    /// A square patch in proportion to its mean weight, then any candidate in it (section 3).
    Patch,
    /// The candidate of the largest weight, uniform over several. Where no weight is above zero, as
    /// [`Pick::Patch`].
    Best,
}

/// What to do at the goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stay {
    /// Explore around it, following what changes (section 2).
    Explore,
    /// Stop there and watch for this time, in the unit of the readings' times; 0 goes on at once.
    Watch(f64),
}

/// Weighs where the robot should look next.
pub trait Strategy: std::fmt::Debug + Send {
    /// The name in tables, files and recordings.
    fn name(&self) -> &'static str;

    /// Writes the worth of a visit of each candidate into `weights`: one weight per cell in row-major order,
    /// all zero at first, in any unit. Only the proportions between candidates count; the weights of other
    /// cells are ignored. A weight that is negative or not a number counts as zero.
    ///
    /// Called once per goal, so a pass over the map is affordable.
    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]);

    /// How the goal is selected by these weights.
    fn pick(&self) -> Pick {
        Pick::Patch
    }

    /// Whether the strategy needs [`Situation::travel`]. By default if it picks the best cell.
    fn needs_travel(&self) -> bool {
        self.pick() == Pick::Best
    }

    /// What to do at the goal that was selected by the last weights.
    fn stay(&mut self, _goal: Cell) -> Stay {
        Stay::Explore
    }
}

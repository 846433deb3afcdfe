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

use crate::Situation;
use interfaces::Cell;

/// How a goal is picked from the weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pick {
    /// A square patch in proportion to its mean weight, then any candidate in it (section 3).
    Patch,
    /// The candidate of the largest weight; of several, any. Where there are none above zero, as
    /// [`Pick::Patch`].
    Best,
}

/// What to do at the goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stay {
    /// Explore around it, following what changes (section 2).
    Explore,
    /// Stand there and watch for so long, in the unit of the readings' times; 0 goes on at once.
    Watch(f64),
}

/// A view on where looking is worth most.
pub trait Strategy: std::fmt::Debug + Send {
    /// The name in tables and on screens.
    fn name(&self) -> &'static str;

    /// Writes what a visit of each candidate is worth into `weights`: one weight per cell in
    /// row-major order, all zero at first, in any unit. Only the proportions between candidates
    /// count; the weights of other cells are ignored. A weight that is negative or not a number
    /// counts as zero.
    ///
    /// Called once per goal, so a pass over the map is in order.
    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]);

    /// How the goal is picked from these weights.
    fn pick(&self) -> Pick {
        Pick::Patch
    }

    /// Whether [`Situation::travel`] is wanted.
    fn needs_travel(&self) -> bool {
        false
    }

    /// What to do at the goal that was picked from the last weights.
    fn stay(&mut self, _goal: Cell) -> Stay {
        Stay::Explore
    }
}

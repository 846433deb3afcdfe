mod poisson;
mod random;
mod recency;

pub use poisson::Poisson;
pub use random::Random;
pub use recency::Recency;

use crate::Situation;

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
}

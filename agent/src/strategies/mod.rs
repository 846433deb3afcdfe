//! To add a strategy: write a file in this folder, add its `mod` line here, and add a line to `BUILT_IN` in `policy.rs`.
//!
//! A row in the table of `docs/strategies.md` is needed as well; a test compares the table with `BUILT_IN`.

mod best_trip;
mod coverage;
mod fresh_map;
mod information_gain;
mod poisson;
mod random;
mod recency;

pub use best_trip::{BestTrip, Elapsed, Worth};
pub use coverage::Age;
pub use fresh_map::Brier;
pub use information_gain::InformationGain;
pub use poisson::Poisson;
pub use random::Random;
pub use recency::Recency;

use crate::situation::Situation;
use interfaces::{Cell, Values};
use mapper::Mapper;

/// How the agent selects the goal by the weights of a strategy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pick {
    /// Draw a square patch with a probability proportional to its mean weight, then any candidate in the patch
    /// (section 3).
    Patch,
    /// Take the candidate with the largest weight, or a random one of several equal ones. If no weight is above
    /// zero, select as with [`Pick::Patch`].
    Best,
}

/// What the robot does at the goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stay {
    /// Explore around the goal and follow what changes (section 2).
    Explore,
    /// Stop at the goal and observe for this duration, in the time unit of the readings. With 0, the next goal
    /// follows at once.
    Watch(f64),
}

/// Gives each cell a weight: how much a visit of the cell is worth.
pub trait Strategy: std::fmt::Debug + Send {
    /// The name in tables, files and recordings.
    fn name(&self) -> &'static str;

    /// Writes the value of a visit of each candidate into `weights`: one weight per cell, in row-major order, in
    /// any unit. All weights are zero at first. Only the ratios between the weights of candidates matter; the
    /// weights of other cells are ignored. A weight that is negative or NaN counts as zero.
    ///
    /// The method is called once per goal, so that a pass over the whole map is affordable.
    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]);

    /// How the agent selects the goal by these weights.
    fn pick(&self) -> Pick {
        Pick::Patch
    }

    /// Whether the strategy needs [`Situation::travel`]. By default this is true for [`Pick::Best`].
    fn needs_travel(&self) -> bool {
        self.pick() == Pick::Best
    }

    /// What the robot does at the goal that was selected by the last weights.
    fn stay(&mut self, _goal: Cell) -> Stay {
        Stay::Explore
    }

    /// The robot leaves the goal that was selected last, there or on the way, and no other goal follows for a while. A
    /// strategy that remembers its goals ends the visit, or forgets the goal if the robot is not there yet; if another goal
    /// follows at once, it ends the visit in [`weigh`](Self::weigh).
    fn end(&mut self, _situation: &Situation) {}

    /// Everything that a goal changes and a later goal needs: what a state file holds of the strategy. `mapper` is that of
    /// the same state; what follows from it is not in the list. Empty for a strategy that remembers nothing.
    fn values(&mut self, _mapper: &Mapper) -> Values<'_> {
        Vec::new()
    }
}

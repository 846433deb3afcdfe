//! The grid world: cells, blocks that move, a robot with an exact sensor (paper, section 5, figure 3).
//!
//! [`GridSpec`] reads a world file or makes a random world, [`GridWorld`] lets time pass in it, a
//! step at a time. [`GridGroundTruth`] is for metrics.
//!
//! In every step the robot acts first: it stays, or moves to one of the four cells that share a
//! side with its own, unless that is blocked. Then the blocks move, in the order of the file. A
//! block that has stood for its dwell moves to the next cell of its path; while the robot or
//! another block is there, it waits, and its dwell begins anew when it has moved. Both happen by
//! chance if the world says so.
//!
//! ```
//! use interfaces::{Cell, Step, World};
//! use sim::grid::{GridSpec, GridWorld};
//!
//! let spec = GridSpec::parse("two_blocks.toml", include_str!("../../../worlds/two_blocks.toml"))?;
//! let mut world = GridWorld::new(&spec, 7);
//! assert_eq!(world.robot(), Cell::new(12, 12));
//! world.act(&Step::Up);
//! world.act(&Step::Stay);
//! assert_eq!(world.robot(), Cell::new(12, 13));
//! // The bottom block moves every two steps.
//! assert!(world.blocks().any(|block| block == ("bottom", Cell::new(5, 1))));
//! let reading = world.sense();
//! assert_eq!(reading.time, 2.0);
//! // Nothing is in the way of a sensor that sees four cells far.
//! assert_eq!(reading.cells.len(), 49);
//! # Ok::<(), sim::WorldError>(())
//! ```

mod block;
mod generate;
mod ground_truth;
mod spec;
#[cfg(test)]
mod tests;
mod visibility;
mod world;

pub use generate::{GenerateSettings, PathKind};
pub use ground_truth::{GridGroundTruth, GridGroundTruth as GridTruth};
pub use spec::{BlockSpec, Course, GridSpec};
pub use world::GridWorld;

//! The grid world: cells, blocks that move, a robot with an exact sensor (paper, section 5, figure 3).
//!
//! [`GridSpec`] describes a world or generates a random one; [`GridWorld`] simulates it step by step.
//! [`GridGroundTruth`] is for metrics.
//!
//! In every step the robot acts first: it stays, or moves to a free cell that shares a side with its cell. Then the
//! blocks move, in the order of the spec. A block that has stayed on its cell for its dwell moves to the next cell
//! of its path; the block waits while the robot or another block is there. The spec can give moves of blocks and
//! actions of the robot a probability below 1.
//!
//! ```
//! use interfaces::{Step, World};
//! use sim::grid::{GenerateSettings, GridSpec, GridWorld};
//!
//! let spec = GridSpec::generate(&GenerateSettings::default(), 7);
//! let mut world = GridWorld::new(&spec, 7);
//! assert_eq!(world.robot(), spec.start);
//! world.act(&Step::Up);
//! assert_eq!(world.sense().time, 1.0);
//! ```

mod generate;
mod ground_truth;
mod spec;
mod visibility;
mod world;

pub use generate::GenerateSettings;
pub use ground_truth::GridGroundTruth;
pub use spec::{BlockSpec, Course, GridCalendar, GridSpec};
pub use world::GridWorld;

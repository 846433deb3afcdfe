//! The grid world: cells, blocks that move, a robot with an exact sensor (paper, section 5, figure 3).
//!
//! [`GridSpec`] describes a world or makes a random one, [`GridWorld`] simulates it, a
//! step at a time. [`GridGroundTruth`] is for metrics.
//!
//! In every step the robot acts first: it stays, or moves to a free cell that shares a side with its own. Then the
//! blocks move, in the order of the spec. A block that has stood for its dwell moves to the next cell of its path; it
//! waits while the robot or another block is there. The spec can give both a probability below 1.
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

mod block;
mod generate;
mod ground_truth;
mod spec;
mod visibility;
mod world;

pub use generate::{GenerateSettings, PathKind};
pub use ground_truth::GridGroundTruth;
pub use spec::{BlockSpec, Course, GridSpec};
pub use world::GridWorld;

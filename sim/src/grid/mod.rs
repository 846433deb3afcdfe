//! The grid world: cells, blocks that move, a robot with an exact sensor (paper, section 5, figure 3).
//!
//! [`GridSpec`] describes a world or makes a random one, [`GridWorld`] lets time pass in it, a
//! step at a time. [`GridGroundTruth`] is for metrics.
//!
//! In every step the robot acts first: it stays, or moves to one of the four cells that share a
//! side with its own, unless that is blocked. Then the blocks move, in the order of the spec. A
//! block that has stood for its dwell moves to the next cell of its path; while the robot or
//! another block is there, it waits, and its dwell begins anew when it has moved. Both happen at
//! random if the spec says so.
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

//! Places for a robot to live in.
//!
//! [`physics`] is the two-dimensional world of the paper's section 5 and figures 4 and 5: walls,
//! robots with real contacts, lasers.
//!
//! [`grid`] is the world of the paper's figure 3: cells that are blocked or free, blocks that move
//! from cell to cell, a robot that takes a step at a time and sees exactly.
//!
//! Both implement [`interfaces::World`], and keep the truth that metrics (and nothing else) may look
//! at.
//!
//! ```
//! use interfaces::{Twist, World};
//! use sim::physics::{PhysicsWorld, WorldSpec};
//!
//! let spec = WorldSpec::parse("four_rooms.toml", include_str!("../../worlds/four_rooms.toml"))?;
//! let mut world = PhysicsWorld::new(&spec, 7);
//! let before = world.sense();
//! world.act(&Twist { linear_mps: 0.5, angular_radps: 0.0 });
//! let after = world.sense();
//! assert_eq!(after.scan.ranges_m.len(), 720);
//! assert!((after.time_s - before.time_s - 0.1).abs() < 1e-9);
//! assert!(after.pose.translation.x > before.pose.translation.x);
//! # Ok::<(), sim::WorldError>(())
//! ```
//!
#![doc = include_str!("hello.md")]

mod error;
mod files;
mod findings;
pub mod floor_plan;
pub mod grid;
mod kind;
mod names;
pub mod physics;
mod reader;
pub mod stage;
mod together;

pub use error::WorldError;
pub use files::{Disk, Files};
pub use findings::{Finding, Findings, Severity};

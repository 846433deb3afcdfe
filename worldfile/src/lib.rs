//! World files: from texts and pictures to the specs of the crate `sim`. It must not know how a world is
//! simulated, or how robots learn.
//!
//! [`physics`] and [`grid`] read the two kinds of world files (TOML), [`floor_plan`] converts pictures and ROS maps
//! to walls, and [`shipped`] has the worlds that are part of the program. All errors of a file are reported at
//! once, with the line and a valid value.
//!
//! ```
//! use interfaces::{Twist, World};
//! use sim::physics::PhysicsWorld;
//!
//! let spec = worldfile::physics::parse_world("four_rooms.toml", include_str!("../../worlds/four_rooms.toml"))?;
//! let mut world = PhysicsWorld::new(&spec, 7);
//! let before = world.sense();
//! world.act(&Twist { linear_mps: 0.5, angular_radps: 0.0 });
//! let after = world.sense();
//! assert_eq!(after.scan.ranges_m.len(), 720);
//! assert!((after.time_s - before.time_s - 0.1).abs() < 1e-9);
//! assert!(after.pose.translation.x > before.pose.translation.x);
//! # Ok::<(), worldfile::WorldError>(())
//! ```
//!
#![doc = include_str!("../hello.md")]

mod error;
mod files;
mod findings;
pub mod floor_plan;
pub mod grid;
pub mod physics;
mod reader;
pub mod ros_map;
mod schedule;
pub mod shipped;
pub mod toml_value;
mod tour;

pub use error::WorldError;
pub use files::{Disk, Files, MAX_TEXT_BYTES};
pub use findings::{Finding, Findings, Severity, SourceText};
pub use tour::TourSpec;

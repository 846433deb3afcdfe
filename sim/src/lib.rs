//! Simulated worlds for a robot, with their ground truth. This is the only crate that knows the physics
//! engine; it must not know files, maps or how a robot decides: a world is a plain struct, which the crates
//! `worldfile` and `stage` make from files.
//!
//! [`physics`] is the two-dimensional world of the paper's section 5 and figures 4 and 5: walls,
//! robots with real contacts, lasers.
//!
//! [`grid`] is the world of the paper's figure 3: cells that are blocked or free, blocks that move from cell to
//! cell, a robot that moves one cell per step and has an exact sensor.
//!
//! Both implement [`interfaces::World`], and keep the ground truth for metrics.
//!
//! ```
//! use interfaces::{GridFrame, Twist, World};
//! use nalgebra::{Isometry2, Point2, Vector2};
//! use sim::physics::*;
//!
//! let robot = RobotSpec::new("curious", Isometry2::translation(1.0, 2.0), BehaviorSpec::Driven);
//! let fleet = FleetSpec {
//!     name: "hall".to_owned(),
//!     description: String::new(),
//!     frame: GridFrame::covering(Point2::origin(), 6.0, 4.0, 0.05).unwrap(),
//!     step_s: 0.05,
//!     contacts: ContactModel::default(),
//!     walls: vec![Rectangle::around(Point2::new(5.0, 2.0), Vector2::new(0.1, 4.0), 0.0)],
//!     glass: Vec::new(),
//!     obstacles: Vec::new(),
//!     robots: vec![robot],
//!     starts_s: None,
//! };
//! let mut world = PhysicsWorld::new(&WorldSpec::new(fleet)?, 7);
//! let before = world.sense();
//! world.act(&Twist { linear_mps: 0.5, angular_radps: 0.0 });
//! let after = world.sense();
//! assert_eq!(after.scan.ranges_m.len(), 360);
//! assert!((after.time_s - before.time_s - 0.1).abs() < 1e-9);
//! assert!(after.pose.translation.x > before.pose.translation.x);
//! # Ok::<(), DrivenError>(())
//! ```

mod building_calendar;
mod flood;
pub mod grid;
pub mod physics;
mod routine;

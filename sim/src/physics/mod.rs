//! The physics world: a house with robots that have bodies and lasers (paper, section 5).
//!
//! [`FleetSpec`] reads a world file with any number of robots, and [`Fleet`] lets time pass in it.
//! [`WorldSpec`] and [`PhysicsWorld`] are the same for a place in which one robot is driven, with the
//! [`Truth`] about every cell, for metrics. Bodies and contacts are rapier's; rays are our own, exact
//! to the geometry.
//!
#![doc = include_str!("../../worlds/keys.md")]

mod bodies;
mod bumper;
mod chance;
mod command;
mod convex;
mod drive;
mod ear;
mod eye;
mod finder;
mod fleet;
mod form;
mod laser;
mod minds;
mod obstacles;
mod odometry;
mod rays;
mod report;
mod robot;
mod shape;
mod snapshot;
mod spec;
#[cfg(test)]
mod tests;
mod truth;
mod world;

pub(crate) use form::Form;
pub(crate) use shape::TOUCH_M;
pub(crate) use spec::{MAX_PIECES, MOST_OUT_M};

pub use command::{Acceleration, Command, Velocity};
pub use fleet::{Controller, Fleet, TeleportError};
pub use report::{Body, Contact, Fiducial, ObstacleEvent, ObstacleView, Ping, RobotView, Sweep};
pub use shape::Rectangle;
pub use snapshot::SnapshotError;
pub use spec::{
    Behaviour, BumperSpec, CircleSpec, DoorSpec, DriveKind, DriveLimits, FiducialSpec, FleetSpec, LaserSpec,
    Leaf, Motion, ObstacleSpec, OdometryError, Opening, PathSpec, PatrolSpec, PushedSpec, Repeat, RobotSpec,
    SonarSpec, WanderSpec, WaypointsSpec, WorldSpec,
};
pub use truth::Truth;
pub use world::PhysicsWorld;

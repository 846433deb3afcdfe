//! The physics world: a house with robots that have bodies and lasers (paper, section 5).
//!
//! [`FleetSpec`] reads a world file with any number of robots, and [`Fleet`] lets time pass in it.
//! [`WorldSpec`] and [`PhysicsWorld`] are the same for a world in which one robot is driven, with the
//! [`PhysicsGroundTruth`] of every cell, for metrics. Bodies and contacts are those of rapier; rays are our
//! own, exact to the geometry.
//!
#![doc = include_str!("../../worlds/keys.md")]

mod behaviors;
mod bodies;
mod command;
mod convex;
mod drives;
mod fleet;
mod form;
mod ground_truth;
mod obstacles;
mod rays;
mod report;
mod robot;
mod sensors;
mod shape;
mod snapshot;
mod spec;
#[cfg(test)]
mod tests;
mod world;

pub(crate) use form::Form;
pub(crate) use shape::TOUCH_M;
pub(crate) use spec::{MAX_PIECES, MOST_OUT_M};

pub use command::{Acceleration, Command, Velocity};
pub use fleet::{Controller, Fleet, TeleportError};
pub use ground_truth::{PhysicsGroundTruth, PhysicsGroundTruth as Truth};
pub use report::{Body, Contact, ObstacleEvent, ObstacleView};
pub use robot::RobotView;
pub use sensors::{Fiducial, SensorReading, SonarReading};
pub use shape::Rectangle;
pub use snapshot::SnapshotError;
pub use spec::{
    Behaviour, BumperSpec, CircleSpec, DoorSpec, DriveKind, DriveLimits, FiducialSpec, FleetSpec, LaserSpec,
    Leaf, Motion, ObstacleSpec, OdometryError, Opening, PathSpec, PatrolSpec, PushedSpec, Repeat, RobotSpec,
    SonarSpec, WanderSpec, WaypointsSpec, WorldSpec,
};
pub use world::PhysicsWorld;

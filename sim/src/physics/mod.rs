//! The physics world: a building and robots with bodies and lasers (paper, section 5).
//!
//! [`FleetSpec`] describes a world with any number of robots, and [`Fleet`] simulates it. [`WorldSpec`] and
//! [`PhysicsWorld`] are the same for a world in which exactly one robot is driven, with the [`PhysicsGroundTruth`]
//! of every cell, for metrics. Bodies and contacts are simulated by rapier. The ray casting is part of this crate,
//! and exact for the given geometry.

mod behaviors;
mod bodies;
mod box_tree;
pub mod convex;
mod drives;
mod fleet;
mod form;
mod free_space;
mod generate;
mod ground_truth;
mod obstacles;
mod past;
mod rays;
mod report;
mod robot;
mod sensors;
pub mod shape;
mod sliding;
mod snapshot;
mod spec;
#[cfg(test)]
mod tests;
mod things;
mod world;

pub use box_tree::BoxTree;
pub use drives::Velocity;
pub use fleet::{Controller, Fleet, LengthError, TeleportError};
pub use form::Form;
pub use free_space::{FreePoses, FreeSpace};
pub use generate::building_ranges;
pub use ground_truth::PhysicsGroundTruth;
pub use report::{Body, Contact, ObstacleEvent, ObstacleView};
pub use robot::RobotView;
pub use sensors::SonarReading;
pub use shape::Rectangle;
pub use snapshot::SnapshotError;
pub use spec::{
    BehaviorSpec, BumperSpec, CircleSpec, ContactModel, DisplacementSpec, DoorSpec, DriveKind, DriveLimits,
    DrivenError, FleetSpec, Glass, LaserSpec, Leaf, Motion, ObstacleSpec, OdometryError, Opening, PathSpec,
    PatrolDaySpec, PatrolSpec, PushedSpec, Repeat, RobotSpec, SonarSpec, ThingPart, WanderSpec,
    WaypointsSpec, WorldSpec,
};
pub use things::Thing;
pub use world::{PhysicsWorld, WorldSnapshot};

//! The physics world: a house with robots that have bodies and lasers (paper, section 5).
//!
//! [`WorldSpec`] reads a world file, [`PhysicsWorld`] lets time pass in it. Bodies and contacts
//! are rapier's; rays are our own, exact to the geometry. [`Truth`] is for metrics.

mod bodies;
mod chance;
mod drive;
mod laser;
mod obstacles;
mod odometry;
mod patrol;
mod rays;
mod report;
mod robot;
mod shape;
mod spec;
#[cfg(test)]
mod tests;
mod truth;
mod world;

pub use report::{Body, Contact, ObstacleEvent, ObstacleView, RobotView, Sweep};
pub use shape::Rectangle;
pub use spec::{
    Behaviour, DriveLimits, LaserSpec, ObstacleSpec, OdometryError, PatrolSpec, RobotSpec, WorldSpec,
};
pub use truth::{TrueChange, TrueState, Truth};
pub use world::PhysicsWorld;

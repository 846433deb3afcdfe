//! The behaviors of robots that drive without commands, by laser and odometry.

mod escape;
mod legs;
mod wall_patrol;
mod wander;
mod waypoints;

use super::rays::Beams;
use super::spec::{BehaviorSpec, RobotSpec};
use interfaces::{LaserReading, RandomStream, Twist, Values};
use nalgebra::Vector2;
use wall_patrol::WallPatrol;
use wander::Wander;
use waypoints::Waypoints;

/// A behavior: a way to drive without commands.
#[derive(Clone)]
pub(super) enum Behavior {
    /// A constant velocity.
    Steady(Twist),
    Wander(Box<Wander>),
    Waypoints(Box<Waypoints>),
    WallPatrol(WallPatrol),
}

impl Behavior {
    /// The behavior of `robot`, whose main laser has `beams`; `None` if the robot executes commands.
    pub(super) fn of(robot: &RobotSpec, step_s: f64, beams: &Beams, random: RandomStream) -> Option<Self> {
        Some(match &robot.behavior {
            BehaviorSpec::Driven => return None,
            BehaviorSpec::Standing => Self::Steady(Twist::STOP),
            BehaviorSpec::Circle(circle) => {
                Self::Steady(Twist { linear_mps: circle.speed_mps, angular_radps: circle.turn_radps })
            }
            BehaviorSpec::Wander(spec) => {
                Self::Wander(Box::new(Wander::new(*spec, robot, step_s, beams, random)))
            }
            BehaviorSpec::Waypoints(spec) => {
                Self::Waypoints(Box::new(Waypoints::new(spec.clone(), robot, step_s, beams, random)))
            }
            BehaviorSpec::WallPatrol(spec) => Self::WallPatrol(WallPatrol::new(*spec, robot, step_s, beams)),
        })
    }

    /// Whether the behavior reads its laser.
    pub(super) fn looks(&self) -> bool {
        !matches!(self, Self::Steady(_))
    }

    /// The velocity until the next reading of the laser, which `read` returns; `None` without a reading.
    pub(super) fn decide<'a>(&mut self, read: impl FnOnce() -> Option<&'a LaserReading>) -> Option<Twist> {
        Some(match self {
            Self::Steady(twist) => *twist,
            Self::Wander(wander) => wander.decide(read()?),
            Self::Waypoints(waypoints) => waypoints.decide(read()?),
            Self::WallPatrol(patrol) => patrol.decide(read()?),
        })
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        match self {
            Self::Steady(_) => Vec::new(),
            Self::Wander(wander) => wander.values(),
            Self::Waypoints(waypoints) => waypoints.values(),
            Self::WallPatrol(patrol) => patrol.values(),
        }
    }
}

/// The unit vectors of the beams of a laser in the frame of its robot.
fn in_robot_frame(robot: &RobotSpec, beams: &Beams) -> Vec<Vector2<f64>> {
    let mount = robot.laser.mount.rotation;
    beams.directions().map(|(x, y)| mount * Vector2::new(x, y)).collect()
}

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
        let chassis = Chassis { robot, beams, step_s };
        Some(match &robot.behavior {
            BehaviorSpec::Driven => return None,
            BehaviorSpec::Standing => Self::Steady(Twist::STOP),
            BehaviorSpec::Circle(circle) => {
                Self::Steady(Twist { linear_mps: circle.speed_mps, angular_radps: circle.turn_radps })
            }
            BehaviorSpec::Wander(spec) => Self::Wander(Box::new(Wander::new(*spec, chassis, random))),
            BehaviorSpec::Waypoints(spec) => {
                Self::Waypoints(Box::new(Waypoints::new(spec.clone(), chassis, random)))
            }
            BehaviorSpec::WallPatrol(spec) => Self::WallPatrol(WallPatrol::new(*spec, chassis)),
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

/// What a behavior drives: a robot, the beams of its main laser, and the length of a step of the world, s.
#[derive(Clone, Copy)]
struct Chassis<'a> {
    robot: &'a RobotSpec,
    beams: &'a Beams,
    step_s: f64,
}

impl Chassis<'_> {
    /// The time between two scans, s.
    fn period_s(&self) -> f64 {
        self.robot.laser.period_steps as f64 * self.step_s
    }

    /// The unit vectors of the beams in the frame of the robot.
    fn beam_directions(&self) -> Vec<Vector2<f64>> {
        let mount = self.robot.laser.mount.rotation;
        self.beams.directions().map(|(x, y)| mount * Vector2::new(x, y)).collect()
    }
}

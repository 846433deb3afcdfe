//! What robots do by themselves, from what they see and feel.

mod pace;
mod patrol;
mod wander;
mod waypoints;

use super::chance::Uniform;
use super::rays::Beams;
use super::snapshot::{Played, Tape};
use super::spec::{Behavior, RobotSpec};
use interfaces::{LaserReading, Twist};
use nalgebra::Vector2;
use patrol::WallPatrol;
use wander::Wander;
use waypoints::Waypoints;

/// A robot's mind.
#[derive(Clone, Debug)]
pub(super) enum Mind {
    /// It obeys commands.
    Driven,
    /// It always does the same.
    Steady(Twist),
    /// See [`Wander`].
    Wander(Box<Wander>),
    /// See [`Waypoints`].
    Waypoints(Waypoints),
    /// See [`WallPatrol`].
    WallPatrol(WallPatrol),
}

impl Mind {
    /// The mind of `robot`, whose laser has `beams`; `chance` is its own.
    pub(super) fn new(robot: &RobotSpec, step_s: f64, beams: &Beams, chance: Uniform) -> Self {
        match &robot.behavior {
            Behavior::Driven => Self::Driven,
            Behavior::Standing => Self::Steady(Twist::STOP),
            Behavior::Circle(circle) => {
                Self::Steady(Twist { linear_mps: circle.speed_mps, angular_radps: circle.turn_radps })
            }
            Behavior::Wander(spec) => {
                Self::Wander(Box::new(Wander::new(*spec, robot, step_s, beams, chance)))
            }
            Behavior::Waypoints(spec) => Self::Waypoints(Waypoints::new(spec.clone(), robot, step_s, beams)),
            Behavior::WallPatrol(spec) => Self::WallPatrol(WallPatrol::new(*spec, robot, step_s, beams)),
        }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        match self {
            Self::Driven | Self::Steady(_) => Ok(()),
            Self::Wander(wander) => wander.play(tape),
            Self::Waypoints(waypoints) => waypoints.play(tape),
            Self::WallPatrol(patrol) => patrol.play(tape),
        }
    }

    /// What to do until the next reading; `None`: whatever it was told.
    pub(super) fn decide(&mut self, reading: &LaserReading) -> Option<Twist> {
        match self {
            Self::Driven => None,
            Self::Steady(twist) => Some(*twist),
            Self::Wander(wander) => Some(wander.decide(reading)),
            Self::Waypoints(waypoints) => Some(waypoints.decide(reading)),
            Self::WallPatrol(patrol) => Some(patrol.decide(reading)),
        }
    }
}

/// The unit vectors of a laser's beams in its robot's frame.
fn in_robot_frame(robot: &RobotSpec, beams: &Beams) -> Vec<Vector2<f64>> {
    let mount = robot.laser.mount.rotation;
    beams.directions().map(|(x, y)| mount * Vector2::new(x, y)).collect()
}

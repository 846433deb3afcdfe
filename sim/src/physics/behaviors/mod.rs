//! What robots do on their own, by their laser and odometry.

mod legs;
mod pace;
mod wall_patrol;
mod wander;
mod waypoints;

use super::rays::Beams;
use super::snapshot::Values;
use super::spec::{Behaviour, RobotSpec};
use interfaces::{LaserReading, RandomStream, Twist};
use nalgebra::Vector2;
use wall_patrol::WallPatrol;
use wander::Wander;
use waypoints::Waypoints;

/// A way to drive without commands.
pub(super) trait Behavior: Send + Sync {
    /// The velocity to drive at until the next reading.
    fn decide(&mut self, reading: &LaserReading) -> Twist;

    /// The values that a snapshot holds.
    fn values(&mut self) -> Values<'_>;

    /// A copy.
    fn boxed(&self) -> Box<dyn Behavior>;
}

impl Clone for Box<dyn Behavior> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}

/// The behavior of `robot`, whose main laser has `beams`; `None`: the robot obeys commands.
pub(super) fn of(
    robot: &RobotSpec,
    step_s: f64,
    beams: &Beams,
    random: RandomStream,
) -> Option<Box<dyn Behavior>> {
    Some(match &robot.behaviour {
        Behaviour::Driven => return None,
        Behaviour::Standing => Box::new(Steady(Twist::STOP)),
        Behaviour::Circle(circle) => {
            Box::new(Steady(Twist { linear_mps: circle.speed_mps, angular_radps: circle.turn_radps }))
        }
        Behaviour::Wander(spec) => Box::new(Wander::new(*spec, robot, step_s, beams, random)),
        Behaviour::Waypoints(spec) => Box::new(Waypoints::new(spec.clone(), robot, step_s, beams)),
        Behaviour::WallPatrol(spec) => Box::new(WallPatrol::new(*spec, robot, step_s, beams)),
    })
}

/// The same velocity at all times.
#[derive(Clone)]
struct Steady(Twist);

impl Behavior for Steady {
    fn decide(&mut self, _: &LaserReading) -> Twist {
        self.0
    }

    fn values(&mut self) -> Values<'_> {
        Vec::new()
    }

    fn boxed(&self) -> Box<dyn Behavior> {
        Box::new(self.clone())
    }
}

/// The unit vectors of the beams of a laser in the frame of its robot.
fn in_robot_frame(robot: &RobotSpec, beams: &Beams) -> Vec<Vector2<f64>> {
    let mount = robot.laser.mount.rotation;
    beams.directions().map(|(x, y)| mount * Vector2::new(x, y)).collect()
}

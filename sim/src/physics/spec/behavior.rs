//! The behavior of a robot.

use crate::physics::shape::Transform;
use nalgebra::Point2;

/// The behavior of a robot.
#[derive(Clone, Debug, PartialEq)]
pub enum BehaviorSpec {
    /// Executes commands.
    Driven,
    /// Does not move.
    Standing,
    /// Drives in a circle and ignores its sensors.
    Circle(CircleSpec),
    /// Drives without a goal, and turns away from obstacles ahead.
    Wander(WanderSpec),
    /// Drives straight from point to point, and turns round where it is blocked for long.
    Waypoints(WaypointsSpec),
    /// Follows a wall between two points, back and forth.
    WallPatrol(PatrolSpec),
}

/// Settings of a drive in a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleSpec {
    /// The linear speed, m/s.
    pub speed_mps: f64,
    /// The angular velocity, counter-clockwise, rad/s.
    pub turn_radps: f64,
}

/// Settings of a drive without a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WanderSpec {
    /// The linear speed while nothing is ahead, m/s.
    pub speed_mps: f64,
    /// The free space that the robot keeps ahead, m.
    pub clearance_m: f64,
}

/// Settings of a drive from point to point. A robot that is blocked for 5 s visits the points in reverse order; if it
/// is blocked in the same place again, it wanders for 3 to 10 s and tries the next point; if it does not leave its
/// place for about half a minute, it escapes in a direction in which its laser sees space.
#[derive(Clone, Debug, PartialEq)]
pub struct WaypointsSpec {
    /// The points, at least one, m.
    pub points: Vec<Point2<f64>>,
    /// The linear speed on the legs, m/s.
    pub speed_mps: f64,
    /// How the robot continues after the last point.
    pub repeat: Repeat,
    /// The free space that the robot keeps to an obstacle ahead, m.
    pub clearance_m: f64,
}

/// How the robot continues after the last waypoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeat {
    /// The robot continues with the first waypoint.
    Loop,
    /// The robot drives to the waypoints in reverse order.
    BackAndForth,
    /// The robot stops.
    Once,
}

/// Settings of a patrol along a wall, back and forth (paper, section 5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatrolSpec {
    /// One end of the path of the center of the robot, m.
    pub from: Point2<f64>,
    /// The other end of the path of the center of the robot, m.
    pub to: Point2<f64>,
    /// The linear speed on the legs, m/s.
    pub speed_mps: f64,
    /// Whether the wall is on the left from `from` to `to`.
    pub wall_on_left: bool,
    /// The distance from the center of the robot to the surface of the wall, m.
    pub wall_distance_m: f64,
    /// The free space that the robot keeps to an obstacle ahead, m.
    pub clearance_m: f64,
}

impl PatrolSpec {
    /// The minimum distance between the wall and the body of the robot, m.
    pub const WALL_RELIEF_M: f64 = 0.05;
}

impl BehaviorSpec {
    /// Moves the points with the world.
    pub(super) fn transform(&mut self, by: &Transform) {
        let points: Vec<&mut Point2<f64>> = match self {
            Self::WallPatrol(patrol) => vec![&mut patrol.from, &mut patrol.to],
            Self::Waypoints(way) => way.points.iter_mut().collect(),
            Self::Driven | Self::Standing | Self::Circle(_) | Self::Wander(_) => Vec::new(),
        };
        for point in points {
            *point = by.point(point);
        }
    }
}

//! What a robot does by itself.

use crate::physics::shape::turned_point;
use nalgebra::{Point2, UnitComplex};

/// What a robot does.
#[derive(Clone, Debug, PartialEq)]
pub enum BehaviorSpec {
    /// It obeys commands.
    Driven,
    /// It stands.
    Standing,
    /// It drives a circle and looks at nothing.
    Circle(CircleSpec),
    /// It drives about, and turns away from what is ahead.
    Wander(WanderSpec),
    /// It drives straight from point to point.
    Waypoints(WaypointsSpec),
    /// It follows a wall between two points, back and forth.
    WallPatrol(PatrolSpec),
}

/// A circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleSpec {
    /// The speed, m/s.
    pub speed_mps: f64,
    /// The turn, counter-clockwise, rad/s.
    pub turn_radps: f64,
}

/// A way without a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WanderSpec {
    /// The speed while nothing is ahead, m/s.
    pub speed_mps: f64,
    /// The free space that the robot keeps ahead, m.
    pub clearance_m: f64,
}

/// A way from point to point.
#[derive(Clone, Debug, PartialEq)]
pub struct WaypointsSpec {
    /// The points, at least one, m.
    pub points: Vec<Point2<f64>>,
    /// The speed on the way, m/s.
    pub speed_mps: f64,
    /// What comes after the last point.
    pub repeat: Repeat,
    /// The free space that the robot keeps ahead when it stops for something, m.
    pub clearance_m: f64,
}

/// What comes after the last waypoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeat {
    /// The first one.
    Loop,
    /// The same way back.
    BackAndForth,
    /// Nothing: the robot stands.
    Once,
}

/// A way along a wall, back and forth (paper, section 5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatrolSpec {
    /// One end of the way of the robot's middle, m.
    pub from: Point2<f64>,
    /// The other end, m.
    pub to: Point2<f64>,
    /// The speed on the way, m/s.
    pub speed_mps: f64,
    /// Whether the wall is on the left on the way from `from` to `to`.
    pub wall_on_left: bool,
    /// The distance from the robot's middle to the wall's surface, m, measured in the file's
    /// house.
    pub wall_distance_m: f64,
    /// The free space that the robot keeps ahead when it stops for something, m.
    pub clearance_m: f64,
}

impl PatrolSpec {
    /// The wall is farther away than the robot's radius by this at least, m.
    pub const WALL_RELIEF_M: f64 = 0.05;
}

impl BehaviorSpec {
    /// The same after the world has turned about `middle` (m).
    pub(super) fn turn(&mut self, turn: &UnitComplex<f64>, middle: &Point2<f64>) {
        let points: Vec<&mut Point2<f64>> = match self {
            Self::WallPatrol(patrol) => vec![&mut patrol.from, &mut patrol.to],
            Self::Waypoints(way) => way.points.iter_mut().collect(),
            Self::Driven | Self::Standing | Self::Circle(_) | Self::Wander(_) => Vec::new(),
        };
        for point in points {
            *point = turned_point(point, turn, middle);
        }
    }
}

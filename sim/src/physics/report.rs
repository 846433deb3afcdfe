//! What happens in a world, and the values that a viewer shows.

use interfaces::Cell;
use nalgebra::Point2;
use serde::{Deserialize, Serialize};

/// A solid body, by its index among the walls, obstacles or robots of the spec.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Deserialize, Serialize)]
pub enum Body {
    /// A wall.
    Wall(usize),
    /// An obstacle.
    Obstacle(usize),
    /// A robot.
    Robot(usize),
}

/// The beginning of a contact between a robot and another body. The two bodies must separate by a millimeter before
/// the next contact is counted. If two robots touch each other, there is one contact for each of them.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Contact {
    /// The time at which the contact began, s.
    pub time_s: f64,
    /// The index of the robot.
    pub robot: usize,
    /// The body that the robot touched.
    pub with: Body,
    /// The position of the contact, m.
    pub at: Point2<f64>,
    /// Whether the robot itself moved: a collision. `false` if the robot stood still and the other body hit it.
    pub moving: bool,
    /// The speed at which the drive of the robot moved the point of contact towards the other body in the step before,
    /// m/s: positive if the robot drove into the body, else the body ran into the robot.
    pub own_speed_mps: f64,
    /// The impulse of the first step of the contact, N·s.
    pub impulse_ns: f64,
}

/// The appearance or disappearance of an obstacle.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct ObstacleEvent {
    /// The time at which the obstacle really appeared or disappeared, s.
    pub time_s: f64,
    /// The index of the obstacle.
    pub obstacle: usize,
    /// The name of the obstacle.
    pub name: String,
    /// Whether the obstacle appeared; `false`: it disappeared.
    pub appeared: bool,
    /// Every cell that the obstacle covers, completely or partly, row by row from the bottom.
    pub cells: Vec<Cell>,
}

/// An obstacle that is present now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleView<'a> {
    /// The index of the obstacle.
    pub index: usize,
    /// The name of the obstacle.
    pub name: &'a str,
    /// The corners, counter-clockwise, m.
    pub corners: [Point2<f64>; 4],
}

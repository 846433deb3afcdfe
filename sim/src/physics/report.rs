//! What happened, and what there is to draw.

use geometry::{Cell, LaserReading, Twist};
use nalgebra::{Isometry2, Point2};

/// Something solid, by its place in the world file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Body {
    /// A wall.
    Wall(usize),
    /// An obstacle.
    Obstacle(usize),
    /// A robot.
    Robot(usize),
}

/// A robot began to touch something. It has to part from it by a millimetre before a touch counts
/// again. Two robots that touch each other have a contact each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// When, s.
    pub time_s: f64,
    /// Which robot, by its place in the world file.
    pub robot: usize,
    /// What it touched.
    pub with: Body,
    /// Whether the robot itself moved: a collision. `false`: it stood, and was run into.
    pub moving: bool,
    /// How hard the first step of the contact was, N·s: the change of momentum that it took.
    pub impulse_ns: f64,
}

/// What an obstacle did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Move {
    /// It was put down.
    Appeared,
    /// It was taken away.
    Disappeared,
}

/// An obstacle was put somewhere, or taken away.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleEvent {
    /// When it really happened, s.
    pub time_s: f64,
    /// The obstacle's place in the world file.
    pub obstacle: usize,
    /// Its name.
    pub name: String,
    /// Whether it appeared; `false`: it disappeared.
    pub appeared: bool,
    /// Every cell that it covers, wholly or in part, row by row from the bottom.
    pub cells: Vec<Cell>,
}

/// A robot, to look at.
#[derive(Clone, Copy, Debug)]
pub struct RobotView<'a> {
    /// Its name.
    pub name: &'a str,
    /// Where it truly is.
    pub pose: Isometry2<f64>,
    /// The radius of its body, m.
    pub radius_m: f64,
    /// Whether it obeys commands.
    pub is_driven: bool,
    /// Its true velocity.
    pub twist: Twist,
    /// Whether it was held back in the last step: by a wall that it drives against, or another robot.
    pub is_stalled: bool,
    /// What it saw last, if it has looked yet.
    pub sweep: Option<&'a Sweep>,
}

/// A reading, and where the laser truly was.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// What the robot got to know, with its pose by odometry.
    pub reading: LaserReading,
    /// The laser's true pose at that time.
    pub laser_pose: Isometry2<f64>,
}

/// An obstacle that is there now, to look at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObstacleView<'a> {
    /// Its place in the world file.
    pub index: usize,
    /// Its name.
    pub name: &'a str,
    /// Its corners, counter-clockwise, m.
    pub corners: [Point2<f64>; 4],
}

//! What happened, and what there is to draw.

use super::ear::Ear;
use super::eye::Eye;
use interfaces::{Cell, LaserReading, Twist};
use nalgebra::{Isometry2, Point2};
use std::fmt;

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
    /// Where, m.
    pub at: Point2<f64>,
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
#[derive(Clone, Copy)]
pub struct RobotView<'a> {
    /// Its place in the world file.
    pub index: usize,
    /// Its name.
    pub name: &'a str,
    /// Where it truly is.
    pub pose: Isometry2<f64>,
    /// The radius of its body, m; with corners: that of the circle about its middle that holds it.
    pub radius_m: f64,
    /// The corners of its body in its own frame, counter-clockwise, m; none: it is round.
    pub corners: &'a [Point2<f64>],
    /// Whether it obeys commands.
    pub is_driven: bool,
    /// Its true velocity.
    pub twist: Twist,
    /// What of it goes to the left, m/s: 0 but for an omni drive.
    pub left_mps: f64,
    /// Whether it was held back in the last step: by a wall that it drives against, or another robot, or a
    /// box that it pushes, which costs it some of its speed.
    pub is_stalled: bool,
    /// What it touches now.
    pub touching: &'a [Body],
    /// What its main laser saw last, if it has looked yet.
    pub sweep: Option<&'a Sweep>,
    /// What its fiducial finder found last, robots first, each in the order of the file.
    pub fiducials: &'a [Fiducial],
    pub(super) eyes: &'a [Eye],
    pub(super) ears: &'a [Ear],
    pub(super) bumpers: (u64, usize),
}

impl<'a> RobotView<'a> {
    /// What each of its lasers saw last, in the order of the file; `None`: it has not looked yet.
    pub fn sweeps(&self) -> impl ExactSizeIterator<Item = Option<&'a Sweep>> + use<'a> {
        self.eyes.iter().map(|eye| eye.sweep.as_ref())
    }

    /// What each of its sonars heard last, in the order of the file; `None`: it has not listened yet.
    pub fn pings(&self) -> impl ExactSizeIterator<Item = Option<Ping>> + use<'a> {
        self.ears.iter().map(|ear| ear.ping)
    }

    /// Whether each of its bumpers touches something now, from right to left.
    pub fn bumpers(&self) -> impl ExactSizeIterator<Item = bool> + use<> {
        let (pressed, sectors) = self.bumpers;
        (0..sectors).map(move |sector| pressed >> sector & 1 == 1)
    }
}

impl fmt::Debug for RobotView<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RobotView")
            .field("name", &self.name)
            .field("pose", &self.pose)
            .finish_non_exhaustive()
    }
}

/// A reading, and where the laser truly was.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// What the robot got to know, with its pose by odometry.
    pub reading: LaserReading,
    /// The laser's true pose at that time.
    pub laser_pose: Isometry2<f64>,
}

/// What a sonar heard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ping {
    /// When, s.
    pub time_s: f64,
    /// How near the nearest thing in its cone is, m; ±∞ as in a laser's scan.
    pub range_m: f32,
}

/// Something with a tag, as a fiducial finder sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fiducial {
    /// Its tag.
    pub tag: u32,
    /// What it is.
    pub body: Body,
    /// The direction of its middle in the finder's frame, counter-clockwise, rad.
    pub bearing_rad: f64,
    /// How far away its middle is, m.
    pub range_m: f64,
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

//! What a world file says, checked and in SI.
//!
//! # Keys
//!
//! Lengths are in metres, times in seconds, angles in degrees counter-clockwise from the x axis.
//! An unknown key is an error. Ranges include their ends.
//!
//! | key | unit | default | range |
//! |---|---|---|---|
//! | `name` | | required | not empty |
//! | `description` | | `""` | |
//! | `map.size_m` | m | required | 0.1 to 1000 each; at most 4 million cells |
//! | `map.cell_m` | m | required | 0.005 to 10; side of a cell of the truth grid |
//! | `map.turn_deg` | ° | 0 | −360 to 360; turns everything about the middle of the map, and the grid grows to cover it |
//! | `physics.step_s` | s | 0.05 | 0.001 to 0.1 |
//! | `[[wall]]` `from_m`, `to_m`, `thickness_m` | m | required¹ | in the map; thickness 0.001 to 100. The wall ends at its points |
//! | `[[wall]]` `min_m`, `max_m` | m | required¹ | in the map; lower left and upper right corner |
//! | `obstacle.name` | | required | unique |
//! | `[[obstacle]]` `min_m`, `max_m` | m | required¹ | in the map, outside of walls |
//! | `[[obstacle]]` `center_m`, `size_m`, `heading_deg` | m, ° | required¹, heading 0 | sides 0.001 to 100 |
//! | `obstacle.appears_s` | s | stands from the start | 0.001 to 10⁹. A box whose place is taken then waits until it is free |
//! | `obstacle.disappears_s` | s | never | 0.001 to 10⁹, after `appears_s` |
//! | `robot.name` | | required | unique |
//! | `robot.radius_m` | m | required | 0.02 to 10 |
//! | `robot.pose_m` | m | required | in the map, clear of everything |
//! | `robot.heading_deg` | ° | 0 | −360 to 360 |
//! | `robot.drive.max_linear_mps` | m/s | required | 0.001 to 5; at most one radius per physics step |
//! | `robot.drive.max_angular_degps` | °/s | required | 0.1 to 3600 |
//! | `robot.drive.max_linear_acceleration_mps2` | m/s² | required | 0.001 to 100 |
//! | `robot.drive.max_angular_acceleration_degps2` | °/s² | required | 0.1 to 100 000 |
//! | `robot.odometry.distance_gain` | | 0 | −0.5 to 0.5; 0.01: a metre is felt as 1.01 m |
//! | `robot.odometry.turn_gain` | | 0 | −0.5 to 0.5; the same for turning |
//! | `robot.odometry.turn_per_m_deg` | °/m | 0 | −90 to 90; felt turn per metre straight on |
//! | `robot.odometry.distance_noise_m` | m | 0 | 0 to 1; standard deviation after 1 m |
//! | `robot.odometry.turn_noise_deg` | ° | 0 | 0 to 90; standard deviation after 1 rad |
//! | `robot.laser.beams` | | required | 2 to 10 000 |
//! | `robot.laser.fov_deg` | ° | 360 | 1 to 360; a full turn has no doubled beam |
//! | `robot.laser.range_min_m` | m | 0 | 0 to 1000, below `range_max_m` |
//! | `robot.laser.range_max_m` | m | required | 0.01 to 1000 |
//! | `robot.laser.rate_hz` | Hz | required | 0.01 to 1000; a scan every whole number of steps |
//! | `robot.laser.mount_m` | m | `[0, 0]` | within the robot's radius |
//! | `robot.laser.mount_deg` | ° | 0 | −360 to 360 |
//! | `robot.laser.noise_std_m` | m | 0 | 0 to 1 |
//! | `robot.behaviour.kind` | | required | `"driven"` (exactly one robot) or `"wall_patrol"` |
//! | `robot.behaviour.from_m`, `to_m` | m | required² | 0.1 m apart or more; the robot fits all the way and starts on it |
//! | `robot.behaviour.speed_mps` | m/s | required² | 0.01 to `max_linear_mps` |
//! | `robot.behaviour.wall_side` | | required² | `"left"` or `"right"`, on the way from `from_m` to `to_m`; the whole way must run along a wall there, its surface 0.05 m beyond the robot or more, and at most 2 m from its middle |
//! | `robot.behaviour.clearance_m` | m | 0.15 | 0.05 to 10; kept free ahead when it stops |
//!
//! ¹ one of the two forms. ² `wall_patrol` only.

mod check;
mod file;
mod numbers;
mod patrol;
mod robot;
#[cfg(test)]
mod tests;

use super::shape::Rectangle;
use crate::error::{Source, WorldError};
use crate::kind::Kind;
use geometry::{GridFrame, Scan};
use nalgebra::{Isometry2, Point2};
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// A physics world as its file describes it: every figure in range, every relation checked.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldSpec {
    pub(super) name: String,
    pub(super) description: String,
    pub(super) frame: GridFrame,
    pub(super) step_s: f64,
    pub(super) walls: Vec<Rectangle>,
    pub(super) obstacles: Vec<ObstacleSpec>,
    pub(super) robots: Vec<RobotSpec>,
    pub(super) driven: usize,
}

impl WorldSpec {
    /// Reads and checks a world file.
    ///
    /// # Errors
    ///
    /// When the file cannot be read, or as in [`WorldSpec::parse`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, WorldError> {
        let name = path.as_ref().display().to_string();
        let text = std::fs::read_to_string(&path).map_err(|error| WorldError::unreadable(&name, &error))?;
        Self::parse(&name, &text)
    }

    /// Checks the text of a world file; `name` is what messages call the file.
    ///
    /// # Errors
    ///
    /// When the text is no TOML, a key is unknown or missing, a value out of range, or the things
    /// in the world contradict each other. The message says where, and what would be right.
    pub fn parse(name: &str, text: &str) -> Result<Self, WorldError> {
        let source = Source { name, text };
        let file = toml::from_str(text).map_err(|error| Kind::Physics.explain(&source, error))?;
        check::check(&source, file)
    }

    /// What the world is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the world shows, in a sentence or two.
    pub fn description(&self) -> &str {
        &self.description
    }

    /// The cells of the truth grid, which cover the house, turned or not.
    pub fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// The physics step, s.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// The walls, in the order of the file.
    pub fn walls(&self) -> &[Rectangle] {
        &self.walls
    }

    /// The obstacles, in the order of the file.
    pub fn obstacles(&self) -> &[ObstacleSpec] {
        &self.obstacles
    }

    /// The robots, in the order of the file.
    pub fn robots(&self) -> &[RobotSpec] {
        &self.robots
    }

    /// The one robot that commands drive.
    pub fn driven(&self) -> &RobotSpec {
        &self.robots[self.driven]
    }
}

/// A box, which may come and go.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleSpec {
    /// What it is called.
    pub name: String,
    /// Where it stands.
    pub shape: Rectangle,
    /// When it is put there, s; `None`: it stands from the start.
    pub appears_s: Option<f64>,
    /// When it is taken away, s; `None`: never.
    pub disappears_s: Option<f64>,
}

impl ObstacleSpec {
    /// Whether it comes or goes at all.
    pub fn is_mover(&self) -> bool {
        self.appears_s.is_some() || self.disappears_s.is_some()
    }
}

/// A round robot with two wheels and a laser.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSpec {
    /// What it is called.
    pub name: String,
    /// The radius of its body, m.
    pub radius_m: f64,
    /// Where it starts.
    pub pose: Isometry2<f64>,
    /// What its wheels can do.
    pub drive: DriveLimits,
    /// How its odometry errs.
    pub odometry: OdometryError,
    /// What it sees with.
    pub laser: LaserSpec,
    /// What it does.
    pub behaviour: Behaviour,
}

/// The bounds of a diff drive, which hold at every physics step. All positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimits {
    /// Forwards and backwards, m/s.
    pub max_linear_mps: f64,
    /// Either way round, rad/s.
    pub max_angular_radps: f64,
    /// Speeding up and braking, m/s².
    pub max_linear_acceleration_mps2: f64,
    /// The same for turning, rad/s².
    pub max_angular_acceleration_radps2: f64,
}

/// How a robot's odometry errs; all zero is exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OdometryError {
    /// Metres felt too many per metre.
    pub distance_gain: f64,
    /// Radians felt too many per radian.
    pub turn_gain: f64,
    /// Radians felt per metre driven straight on.
    pub turn_radpm: f64,
    /// Standard deviation of the distance after 1 m, m; it grows with the square root of the way.
    pub distance_noise_m: f64,
    /// Standard deviation of the heading after a turn of 1 rad, rad; it grows likewise.
    pub turn_noise_rad: f64,
}

/// A planar laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserSpec {
    /// The number of beams.
    pub beams: usize,
    /// The angle they are spread over, rad, in (0, 2π].
    pub fov_rad: f64,
    /// Nearer things give −∞, m.
    pub range_min_m: f64,
    /// Farther things give +∞, m.
    pub range_max_m: f64,
    /// Scans per second, Hz.
    pub rate_hz: f64,
    /// The physics steps from one scan to the next; at least 1.
    pub period_steps: u64,
    /// Where it sits on the robot.
    pub mount: Isometry2<f64>,
    /// Standard deviation of a range, m.
    pub noise_std_m: f64,
}

impl LaserSpec {
    /// The direction of the first beam in the laser's frame, rad.
    pub fn angle_min_rad(&self) -> f64 {
        if self.is_full_turn() { -PI } else { -self.fov_rad / 2.0 }
    }

    /// The angle from beam to beam, rad. Of a full turn the last beam is a neighbour of the
    /// first; of less, the first and the last lie on the borders.
    pub fn angle_increment_rad(&self) -> f64 {
        let gaps = if self.is_full_turn() { self.beams } else { self.beams - 1 };
        self.fov_rad / gaps as f64
    }

    /// A scan of this laser that has seen nothing: no return on any beam.
    pub fn empty_scan(&self) -> Scan {
        Scan {
            angle_min_rad: self.angle_min_rad(),
            angle_increment_rad: self.angle_increment_rad(),
            range_min_m: self.range_min_m,
            range_max_m: self.range_max_m,
            ranges_m: vec![f32::INFINITY; self.beams],
        }
    }

    fn is_full_turn(&self) -> bool {
        self.fov_rad > TAU - 1e-9
    }
}

/// What a robot does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Behaviour {
    /// It obeys the commands given to the world.
    Driven,
    /// It follows a wall between two points, back and forth.
    WallPatrol(PatrolSpec),
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

//! What a world file says, checked and in SI. All keys are in `worlds/keys.md`.

mod behaviour;
mod check;
mod file;
mod floor_plan;
mod numbers;
mod obstacle;
mod patrol;
mod robot;
#[cfg(test)]
mod tests;

pub use behaviour::{Behaviour, CircleSpec, PatrolSpec, Repeat, WanderSpec, WaypointsSpec};
pub use obstacle::{DoorSpec, Leaf, Motion, ObstacleSpec, Opening, PathSpec, PushedSpec};

use super::shape::Rectangle;
use crate::error::{Source, WorldError};
use crate::files::{Disk, Files};
use geometry::{GridFrame, Scan};
use nalgebra::Isometry2;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};

/// A place with any number of robots, as its file describes it: every figure in range, every
/// relation checked.
#[derive(Clone, Debug, PartialEq)]
pub struct FleetSpec {
    pub(super) name: String,
    pub(super) description: String,
    pub(super) frame: GridFrame,
    pub(super) step_s: f64,
    pub(super) walls: Vec<Rectangle>,
    pub(super) obstacles: Vec<ObstacleSpec>,
    pub(super) robots: Vec<RobotSpec>,
}

impl FleetSpec {
    /// Reads and checks a world file, in which any number of robots may be driven, or none.
    ///
    /// # Errors
    ///
    /// When the file cannot be read, or as in [`FleetSpec::parse`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, WorldError> {
        let (name, text) = read(path.as_ref())?;
        Self::parse_with(&name, &text, &Disk)
    }

    /// Checks the text of a world file; `name` is what messages call the file. There are no
    /// pictures beside it.
    ///
    /// # Errors
    ///
    /// When the text is no TOML, a key is unknown or missing, a value out of range, or the things
    /// in the world contradict each other. The message says where, and what would be right.
    pub fn parse(name: &str, text: &str) -> Result<Self, WorldError> {
        Self::parse_with(name, text, &no_files())
    }

    /// The same with the pictures of its floor plans, which are looked for in the folder of the
    /// path `name`.
    ///
    /// # Errors
    ///
    /// As [`FleetSpec::parse`], and when a picture cannot be read.
    pub fn parse_with(name: &str, text: &str, files: &dyn Files) -> Result<Self, WorldError> {
        let source = Source { name, text };
        check::check(&source, &check::file(&source)?, files)
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
}

/// A place in which exactly one robot is driven: the one that explores.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldSpec {
    pub(super) fleet: FleetSpec,
    pub(super) driven: usize,
}

impl WorldSpec {
    /// Reads and checks a world file.
    ///
    /// # Errors
    ///
    /// When the file cannot be read, or as in [`WorldSpec::parse`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, WorldError> {
        let (name, text) = read(path.as_ref())?;
        Self::parse_with(&name, &text, &Disk)
    }

    /// Checks the text of a world file; `name` is what messages call the file.
    ///
    /// # Errors
    ///
    /// As [`FleetSpec::parse`], and when not exactly one robot is driven.
    pub fn parse(name: &str, text: &str) -> Result<Self, WorldError> {
        Self::parse_with(name, text, &no_files())
    }

    /// The same with the pictures of its floor plans, which are looked for in the folder of the
    /// path `name`.
    ///
    /// # Errors
    ///
    /// As [`WorldSpec::parse`], and when a picture cannot be read.
    pub fn parse_with(name: &str, text: &str, files: &dyn Files) -> Result<Self, WorldError> {
        let source = Source { name, text };
        let file = check::file(&source)?;
        let fleet = check::check(&source, &file, files)?;
        let driven = check::driven(&source, &file, &fleet.robots)?;
        Ok(Self { fleet, driven })
    }

    /// The same place for the simulator of fleets.
    pub fn fleet(&self) -> &FleetSpec {
        &self.fleet
    }

    /// What the world is called.
    pub fn name(&self) -> &str {
        &self.fleet.name
    }

    /// What the world shows, in a sentence or two.
    pub fn description(&self) -> &str {
        &self.fleet.description
    }

    /// The cells of the truth grid, which cover the house, turned or not.
    pub fn frame(&self) -> &GridFrame {
        &self.fleet.frame
    }

    /// The physics step, s.
    pub fn step_s(&self) -> f64 {
        self.fleet.step_s
    }

    /// The walls, in the order of the file.
    pub fn walls(&self) -> &[Rectangle] {
        &self.fleet.walls
    }

    /// The obstacles, in the order of the file.
    pub fn obstacles(&self) -> &[ObstacleSpec] {
        &self.fleet.obstacles
    }

    /// The robots, in the order of the file.
    pub fn robots(&self) -> &[RobotSpec] {
        &self.fleet.robots
    }

    /// The one robot that commands drive.
    pub fn driven(&self) -> &RobotSpec {
        &self.fleet.robots[self.driven]
    }
}

/// What messages call a world file, and its text.
fn read(path: &Path) -> Result<(String, String), WorldError> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|error| WorldError::unreadable(&name, &error))?;
    Ok((name, text))
}

/// Where a world file without a folder finds its pictures: nowhere.
fn no_files() -> BTreeMap<PathBuf, Vec<u8>> {
    BTreeMap::new()
}

/// A round robot with two wheels and a laser.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSpec {
    /// What it is called.
    pub name: String,
    /// The radius of its body, m.
    pub radius_m: f64,
    /// Its mass, kg; `None`: 1 kg per m² of its area. It counts when robots push each other.
    pub mass_kg: Option<f64>,
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

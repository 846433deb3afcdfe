//! What a world file says, checked and in SI. All keys are in `worlds/keys.md`.

mod behaviour;
mod check;
mod drive;
mod file;
mod floor_plan;
mod footprint;
mod laser;
mod numbers;
mod obstacle;
mod parts;
mod patrol;
mod robot;
mod senses;
#[cfg(test)]
mod tests;

pub(crate) use floor_plan::MAX_PIECES;
pub(crate) use laser::MOST_OUT_M;

pub use behaviour::{Behaviour, CircleSpec, PatrolSpec, Repeat, WanderSpec, WaypointsSpec};
pub use obstacle::{DoorSpec, Leaf, Motion, ObstacleSpec, Opening, PathSpec, PushedSpec};
pub use parts::{DriveKind, DriveLimits, LaserSpec, OdometryError, RobotSpec};
pub use senses::{BumperSpec, FiducialSpec, SonarSpec};

use super::shape::Rectangle;
use crate::error::{Source, WorldError};
use crate::files::{Disk, Files};
use crate::kind::Kind;
use crate::reader;
use interfaces::GridFrame;
use std::collections::BTreeMap;
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
    /// in the world contradict each other. The messages say where, and what would be right: of everything
    /// that is wrong, as far as one thing does not hide another.
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
        let source = Source::new(name, text);
        check::check(&source, &reader::read(&source, Kind::Physics)?, files)
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
        let source = Source::new(name, text);
        let reading = reader::read(&source, Kind::Physics)?;
        let fleet = check::check(&source, &reading, files)?;
        let driven = check::driven(&source, &reading.file, &fleet.robots)?;
        Ok(Self { fleet, driven })
    }

    /// The place of `fleet` with one of its robots driven, by its place among them, whatever it does there;
    /// others that would obey commands stand still. None if there is no such robot.
    pub fn driving(mut fleet: FleetSpec, driven: usize) -> Option<Self> {
        for robot in fleet.robots.iter_mut().filter(|robot| robot.behaviour == Behaviour::Driven) {
            robot.behaviour = Behaviour::Standing;
        }
        fleet.robots.get_mut(driven)?.behaviour = Behaviour::Driven;
        Some(Self { fleet, driven })
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

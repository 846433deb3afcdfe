//! World files of the physics world.
//!
#![doc = include_str!("../../keys.md")]

mod behavior;
mod check;
mod drive;
mod floor_plan;
mod kind;
mod obstacle;
mod robot;
mod sensor;
mod space;
#[cfg(test)]
mod tests;
mod write;

pub use floor_plan::MAX_PIECES;
pub use sensor::MAX_OUT_M;
pub use write::to_toml;

use crate::error::{WorldError, read_text};
use crate::files::{Disk, Files};
use crate::reader::{self, Kind};
use sim::physics::{FleetSpec, WorldSpec};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Checks the text of a world file in which any number of robots can be driven, including none; `name` is the name
/// of the file in messages. The world must not use pictures.
///
/// # Errors
///
/// When the text is not TOML, a key is unknown or missing, a value is out of range, or parts of the world
/// contradict each other. The messages state the place and a valid value, for everything that is invalid, unless
/// one error hides another.
pub fn parse_fleet(name: &str, text: &str) -> Result<FleetSpec, WorldError> {
    parse_fleet_with(name, text, &no_files())
}

/// Checks the text of a world file as [`parse_fleet`] does, with floor plans. Their pictures are read from the
/// folder of the path `name`.
///
/// # Errors
///
/// The errors of [`parse_fleet`], and when a picture cannot be read.
pub fn parse_fleet_with(name: &str, text: &str, files: &dyn Files) -> Result<FleetSpec, WorldError> {
    reader::read(name, text, Kind::Physics, check::KEYS, |root| check::fleet(root, files))
}

/// Reads and checks a world file.
///
/// # Errors
///
/// When the file cannot be read, and the errors of [`parse_world`].
pub fn load_world(path: impl AsRef<Path>) -> Result<WorldSpec, WorldError> {
    let (name, text) = read_text("world file", path.as_ref())?;
    parse_world_with(&name, &text, &Disk)
}

/// Checks the text of a world file in which exactly one robot is driven; `name` is the name of the file in
/// messages.
///
/// # Errors
///
/// The errors of [`parse_fleet`], and when the number of driven robots is not one.
pub fn parse_world(name: &str, text: &str) -> Result<WorldSpec, WorldError> {
    parse_world_with(name, text, &no_files())
}

/// Checks the text of a world file as [`parse_world`] does, with floor plans. Their pictures are read from the
/// folder of the path `name`.
///
/// # Errors
///
/// The errors of [`parse_world`], and when a picture cannot be read.
pub fn parse_world_with(name: &str, text: &str, files: &dyn Files) -> Result<WorldSpec, WorldError> {
    reader::read(name, text, Kind::Physics, check::KEYS, |root| {
        check::fleet(root, files).and_then(|fleet| check::world(root, fleet))
    })
}

/// The pictures beside a world file without a folder.
fn no_files() -> BTreeMap<PathBuf, Vec<u8>> {
    BTreeMap::new()
}

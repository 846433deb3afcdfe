//! World files of the grid world.
//!
//! # Keys
//!
//! Cells are named `[x, y]`: column and row, from `[0, 0]` at the lower left. Times are in steps. An
//! unknown key is an error. Ranges include their ends.
//!
//! | key | default | range |
//! |---|---|---|
//! | `name` | required | not empty |
//! | `description` | `""` | |
//! | `sensor_radius` | required | 1 to 100 cells |
//! | `map` | required | rows of equal length, the top row first: `#` wall, `.` free, `R` where the robot starts (free; without one it starts in the center, column width / 2 and row height / 2, rounded down); 3 × 3 to 4 million cells |
//! | `transitions.block_chance` | 1 | above 0, at most 1: the probability per step that a block which is due moves |
//! | `transitions.robot_chance` | 1 | above 0, at most 1: the probability that the robot's action happens |
//! | `block.name` | required | unique |
//! | `block.dwell` | required | 1 to 1 000 000 steps on every cell |
//! | `block.stood` | 0 | 0 to `dwell` − 1: steps that it has stood on its first cell when time begins |
//! | `block.course` | required | `"loop"`: from the last cell on to the first; `"back-and-forth"` |
//! | `block.path` | required | way points, joined by straight lines along rows and columns, clear of walls; two cells or more, of all blocks together at most 10 million |

mod check;
mod map;
mod path;
#[cfg(test)]
mod tests;
mod write;

pub use write::to_toml;

use crate::error::{WorldError, read_text};
use crate::reader::{self, Kind};
use sim::grid::GridSpec;
use std::path::Path;

/// Reads and checks a world file.
///
/// # Errors
///
/// When the file cannot be read, and the errors of [`parse`].
pub fn load(path: impl AsRef<Path>) -> Result<GridSpec, WorldError> {
    let (name, text) = read_text("world file", path.as_ref())?;
    parse(&name, &text)
}

/// Whether a text in TOML is the file of a grid world: its `map` is a drawing. That of a physics world is a table.
pub fn is_grid_world(text: &str) -> bool {
    text.parse::<toml::Table>().is_ok_and(|file| file.get("map").is_some_and(toml::Value::is_str))
}

/// Checks the text of a world file; `file_name` is the name of the file in messages.
///
/// # Errors
///
/// When the text is not TOML, a key is unknown or missing, a value is out of range, or parts of the world
/// contradict each other. The messages state the place and a valid value, for everything that is invalid, unless
/// one error hides another.
pub fn parse(file_name: &str, text: &str) -> Result<GridSpec, WorldError> {
    reader::read(file_name, text, Kind::Grid, check::KEYS, check::world)
}

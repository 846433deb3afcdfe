//! What a grid world's file says, checked.
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
//! | `map` | required | rows of equal length, the top row first: `#` wall, `.` free, `R` where the robot starts (free; without one it starts in the centre, column width / 2 and row height / 2, rounded down); 3 × 3 to 4 million cells |
//! | `transitions.block_chance` | 1 | above 0, at most 1: the chance per step that a block which is due moves |
//! | `transitions.robot_chance` | 1 | above 0, at most 1: the chance that the robot's action happens |
//! | `block.name` | required | unique |
//! | `block.dwell` | required | 1 to 1 000 000 steps on every cell |
//! | `block.stood` | 0 | 0 to `dwell` − 1: steps that it has stood on its first cell when time begins |
//! | `block.course` | required | `"loop"`: from the last cell on to the first; `"back-and-forth"` |
//! | `block.path` | required | way points, joined by straight lines along rows and columns, clear of walls; two cells or more |

mod check;
mod file;
mod map;
pub(super) mod parts;
mod path;
#[cfg(test)]
mod tests;
mod write;

use crate::error::{Source, WorldError};
use crate::kind::Kind;
use crate::reader;
use interfaces::{Cell, Grid, GridFrame};
use std::path::Path;

/// The farthest that a sensor can see, in cells.
pub(super) const MAX_SENSOR_RADIUS: u32 = 100;
/// A block that stands longer moves in no run worth while, steps.
pub(super) const MAX_DWELL: u32 = 1_000_000;

/// A grid world as its file describes it: every figure in range, every relation checked.
#[derive(Clone, Debug, PartialEq)]
pub struct GridSpec {
    pub(super) name: String,
    pub(super) description: String,
    pub(super) walls: Grid<bool>,
    pub(super) blocks: Vec<BlockSpec>,
    pub(super) start: Cell,
    pub(super) sensor_radius: u32,
    pub(super) block_chance: f64,
    pub(super) robot_chance: f64,
    pub(super) warnings: Vec<String>,
}

/// A block: it stands for a while on a cell of its path, and moves on to the next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockSpec {
    /// What it is called.
    pub name: String,
    /// How long it stands on every cell, steps; at least 1.
    pub dwell: u32,
    /// How long it has stood on its first cell when time begins, steps; below `dwell`.
    pub stood: u32,
    /// What it does at the end of its path.
    pub course: Course,
    /// Every cell of the path; it starts on the first. Consecutive cells share a side, and so do
    /// the last and the first of a loop. At least two, none of them a wall.
    pub path: Vec<Cell>,
}

/// What a block does at the end of its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Course {
    /// It goes on with the first cell.
    Loop,
    /// It turns round.
    BackAndForth,
}

impl GridSpec {
    /// Reads and checks a world file.
    ///
    /// # Errors
    ///
    /// When the file cannot be read, or as in [`GridSpec::parse`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, WorldError> {
        let name = path.as_ref().display().to_string();
        let text = std::fs::read_to_string(&path).map_err(|error| WorldError::unreadable(&name, &error))?;
        Self::parse(&name, &text)
    }

    /// Checks the text of a world file; `file_name` is what messages call the file.
    ///
    /// # Errors
    ///
    /// When the text is no TOML, a key is unknown or missing, a value out of range, or the things
    /// in the world contradict each other. The messages say where, and what would be right: of everything
    /// that is wrong, as far as one thing does not hide another.
    pub fn parse(file_name: &str, text: &str) -> Result<Self, WorldError> {
        let source = Source::new(file_name, text);
        check::check(&source, reader::read(&source, Kind::Grid)?)
    }

    /// What the world is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the world shows, in a sentence or two.
    pub fn description(&self) -> &str {
        &self.description
    }

    /// The cells: of 1 m, with `[0, 0]` at the origin.
    pub fn frame(&self) -> &GridFrame {
        self.walls.frame()
    }

    /// Which cells are walls.
    pub fn walls(&self) -> &Grid<bool> {
        &self.walls
    }

    /// The blocks, in the order of the file, which is the order they move in.
    pub fn blocks(&self) -> &[BlockSpec] {
        &self.blocks
    }

    /// Where the robot starts.
    pub fn start(&self) -> Cell {
        self.start
    }

    /// How far the robot sees, in cells from the centre of its own to the centre of another.
    pub fn sensor_radius(&self) -> u32 {
        self.sensor_radius
    }

    /// The chance per step that a block which is due moves; above 0, at most 1.
    pub fn block_chance(&self) -> f64 {
        self.block_chance
    }

    /// The chance that an action of the robot happens; above 0, at most 1.
    pub fn robot_chance(&self) -> f64 {
        self.robot_chance
    }

    /// What is not wrong, but may be a mistake: a sentence for every part of the map that the robot
    /// cannot reach, named by its lowest, leftmost cell and its size.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The same world with another sensor; the radius is cut to 1 to 100 cells.
    #[must_use]
    pub fn with_sensor_radius(self, sensor_radius: u32) -> Self {
        Self { sensor_radius: sensor_radius.clamp(1, MAX_SENSOR_RADIUS), ..self }
    }

    /// The same world with other chances ([`GridSpec::block_chance`], [`GridSpec::robot_chance`]),
    /// cut to above 0 and at most 1; what is no number is the least.
    #[must_use]
    pub fn with_chances(self, block: f64, robot: f64) -> Self {
        let cut = |chance: f64| if chance > 0.0 { chance.min(1.0) } else { f64::MIN_POSITIVE };
        Self { block_chance: cut(block), robot_chance: cut(robot), ..self }
    }

    /// The map as in the file: `#` wall, `.` free, `R` where the robot starts; the top row first.
    pub fn drawing(&self) -> String {
        let frame = self.frame();
        let mut drawing = String::with_capacity((frame.width() + 1) * frame.height());
        for y in (0..frame.height() as i32).rev() {
            for x in 0..frame.width() as i32 {
                let cell = Cell::new(x, y);
                drawing.push(match self.walls.get(cell) {
                    _ if cell == self.start => 'R',
                    Some(true) => '#',
                    _ => '.',
                });
            }
            drawing.push('\n');
        }
        drawing
    }

    /// The text of a file that describes this world: [`GridSpec::parse`] makes the same of it.
    pub fn to_toml(&self) -> String {
        write::toml(self)
    }
}

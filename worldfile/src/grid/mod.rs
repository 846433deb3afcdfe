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
//! | `starts` | Monday 0:00 if a block has a schedule | the time of the week, local civil time, at which the world starts, as in `"Mon 7:00"` |
//! | `step_s` | 10 | 0.001 to 86 400: the time of a step of a world with a calendar, s |
//! | `sensor_radius` | required | 1 to 100 cells |
//! | `map` | required | rows of equal length, the top row first: `#` wall, `.` free, `R` where the robot starts (free; without one it starts in the center, column width / 2 and row height / 2, rounded down); 3 × 3 to 4 million cells |
//! | `transitions.block_chance` | 1 | 1e-9 to 1: the probability per step that a block which is due moves; a block with a schedule does not use it |
//! | `transitions.robot_chance` | 1 | 1e-9 to 1: the probability that the robot's action happens |
//! | `block.name` | required | unique |
//! | `block.dwell` | required | 1 to 1 000 000 steps on every cell |
//! | `block.stood` | 0 | 0 to `dwell` − 1: steps that it has stood on its first cell when time begins |
//! | `block.course` | required | `"loop"`: from the last cell on to the first; `"back-and-forth"` |
//! | `block.path` | required | way points, joined by straight lines along rows and columns, clear of walls; two cells or more, of all blocks together at most 10 million |
//! | `block.schedule` | none | a table with [the keys of physics worlds](crate::physics), in place of `dwell`, `stood` and `course`: when the block is on the first cell of its path (blocked) and when on the last (free); it moves there one cell per step |

mod check;
mod map;
mod path;
#[cfg(test)]
mod tests;

use crate::error::{WorldError, read_text};
use crate::reader::{self, Kind};
use crate::schedule::write_schedule;
use crate::toml_value::lines;
use interfaces::Cell;
use sim::grid::GridSpec;
use std::path::Path;
use toml::Value;

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

/// The text of a world file that describes `spec`: [`parse`] reads the same spec from it.
pub fn to_toml(spec: &GridSpec) -> String {
    let [name, description] = [&spec.name, &spec.description].map(|text| Value::from(text.as_str()));
    let calendar = spec.calendar.map(|steps| {
        [("starts", Value::from(calendar::moment(steps.starts_s))), ("step_s", steps.step_s.into())]
    });
    let head = [("name", name), ("description", description)];
    let sensor_radius = ("sensor_radius", Value::from(spec.sensor_radius));
    let mut text = lines(head.into_iter().chain(calendar.into_iter().flatten()).chain([sensor_radius]));
    text += &format!("map = \"\"\"\n{}\"\"\"\n", spec.drawing());
    let [block, robot] = [spec.block_probability, spec.robot_probability];
    if block != 1.0 || robot != 1.0 {
        text += "\n[transitions]\n";
        text += &lines([("block_chance", block.into()), ("robot_chance", robot.into())]);
    }
    for block in &spec.blocks {
        let stood = (block.stood > 0).then(|| ("stood", Value::from(block.stood)));
        let word = check::COURSES.iter().find(|(_, course)| *course == block.course);
        let course = word.map_or("", |(word, _)| *word);
        let points: Vec<Value> = way_points(&block.path).map(|cell| vec![cell.x, cell.y].into()).collect();
        text += "\n[[block]]\n";
        if let Some(schedule) = &block.schedule {
            text += &lines([("name", block.name.as_str().into()), ("path", points.into())]);
            text += "\n[block.schedule]\n";
            text += &lines(write_schedule(schedule));
            continue;
        }
        text += &lines([("name", block.name.as_str().into()), ("dwell", block.dwell.into())]);
        text += &lines(stood.into_iter().chain([("course", course.into()), ("path", points.into())]));
    }
    text
}

/// The cells where the path begins, turns and ends.
fn way_points(path: &[Cell]) -> impl Iterator<Item = Cell> {
    let turns = |at: usize| {
        let (Some(before), Some(after)) = (at.checked_sub(1).map(|at| path[at]), path.get(at + 1)) else {
            return true;
        };
        before.x + after.x != 2 * path[at].x || before.y + after.y != 2 * path[at].y
    };
    (0..path.len()).filter(move |at| turns(*at)).map(|at| path[at])
}

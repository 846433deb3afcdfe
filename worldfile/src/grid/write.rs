//! A world as the text of its file.

use interfaces::Cell;
use sim::grid::{Course, GridSpec};
use std::fmt::Write;

/// The text of a world file that describes `spec`: [`super::parse`] reads the same spec from it.
pub fn to_toml(spec: &GridSpec) -> String {
    let mut text = String::new();
    write(spec, &mut text).expect("a String takes all that is written");
    text
}

fn write(spec: &GridSpec, text: &mut String) -> std::fmt::Result {
    writeln!(text, "name = {}", quoted(&spec.name))?;
    writeln!(text, "description = {}", quoted(&spec.description))?;
    writeln!(text, "sensor_radius = {}", spec.sensor_radius)?;
    writeln!(text, "map = \"\"\"\n{}\"\"\"", spec.drawing())?;
    if spec.block_probability != 1.0 || spec.robot_probability != 1.0 {
        writeln!(text, "\n[transitions]")?;
        writeln!(text, "block_chance = {:?}", spec.block_probability)?;
        writeln!(text, "robot_chance = {:?}", spec.robot_probability)?;
    }
    for block in &spec.blocks {
        let course = match block.course {
            Course::Loop => "loop",
            Course::BackAndForth => "back-and-forth",
        };
        writeln!(text, "\n[[block]]")?;
        writeln!(text, "name = {}", quoted(&block.name))?;
        writeln!(text, "dwell = {}", block.dwell)?;
        if block.stood > 0 {
            writeln!(text, "stood = {}", block.stood)?;
        }
        writeln!(text, "course = \"{course}\"")?;
        let points = way_points(&block.path).map(|cell| format!("[{}, {}]", cell.x, cell.y));
        writeln!(text, "path = [{}]", points.collect::<Vec<_>>().join(", "))?;
    }
    Ok(())
}

/// A text with its quotes, as TOML wants it.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
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

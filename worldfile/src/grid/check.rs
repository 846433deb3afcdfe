//! From the tables of a world file to the spec of a world.

use super::map::{Drawing, drawing};
use super::path;
use crate::reader::{Table, unique_names, valid};
use crate::schedule::{schedule, starts_s};
use interfaces::Cell;
use sim::grid::{BlockSpec, Course, GridCalendar, GridSpec};
use std::collections::BTreeMap;
use std::ops::Range;

/// The keys of a world file.
pub(super) const KEYS: &str = "name, description, starts, step_s, sensor_radius, map, transitions, block";

/// The courses of blocks.
pub(super) const COURSES: [(&str, Course); 2] =
    [("loop", Course::Loop), ("back-and-forth", Course::BackAndForth)];
/// The time of a step unless another one is given, s.
const STEP_S: f64 = 10.0;
/// The maximum number of cells of all paths together: they are kept in memory.
const MAX_PATH_CELLS: usize = 10_000_000;

pub(super) fn world(root: &Table<'_>) -> Option<GridSpec> {
    let name = root.name();
    let description = root.description();
    let sensor_radius = root.needed("sensor_radius");
    let sensor_radius =
        sensor_radius.and_then(|value| value.integer_within(&(1..=GridSpec::MAX_SENSOR_RADIUS)));
    let drawing = root.needed("map").and_then(|map| drawing(root.file, map.text()?, map.span()));
    let chances = root.table_or_empty("transitions", "block_chance, robot_chance").map(|table| {
        ["block_chance", "robot_chance"].map(|key| valid(table.number_or(key, 1.0, 1e-9..=1.0)))
    });
    let tables = root.tables("block", "name, dwell, stood, course, path, schedule");
    unique_names("block", &tables);
    let mut blocks: Vec<BlockSpec> = Vec::new();
    let (mut starts, mut cells) = (BTreeMap::new(), 0);
    for table in &tables {
        let Some(block) = block(table, drawing.as_ref()) else { continue };
        cells += block.path.len();
        if cells > MAX_PATH_CELLS {
            let what = format!("the paths of the blocks have more than {MAX_PATH_CELLS} cells together");
            let help = "give the file fewer blocks, or blocks with shorter paths";
            table.error::<()>(&what, (table.at("path"), "with this path"), &[], help);
            break;
        }
        if let Some(drawing) = &drawing {
            apart(table, &block, &mut starts, drawing);
        }
        blocks.push(block);
    }
    let calendar = calendar(root, blocks.iter().any(|block| block.schedule.is_some()));
    let (drawing, [block_probability, robot_probability]) = (drawing?, chances?);
    Some(GridSpec {
        name: name?,
        description: description?,
        walls: drawing.walls,
        blocks,
        start: drawing.start,
        sensor_radius: sensor_radius?,
        block_probability: block_probability?,
        robot_probability: robot_probability?,
        calendar: calendar?,
    })
}

/// The calendar of the world, `Some(None)` if it has none.
fn calendar(root: &Table<'_>, is_needed: bool) -> Option<Option<GridCalendar>> {
    let starts_s = starts_s(root, is_needed || root.has("step_s"));
    let step_s = valid(root.number_or("step_s", STEP_S, 0.001..=86_400.0));
    Some(starts_s?.zip(Some(step_s?)).map(|(starts_s, step_s)| GridCalendar { starts_s, step_s }))
}

fn block(table: &Table<'_>, drawing: Option<&Drawing>) -> Option<BlockSpec> {
    let name = table.name();
    if table.has("schedule") {
        return scheduled(table, &name?, drawing);
    }
    let dwell = table.needed("dwell").and_then(|value| value.integer_within(&(1..=BlockSpec::MAX_DWELL)));
    let longest = dwell.unwrap_or(BlockSpec::MAX_DWELL + 1) - 1;
    let stood = table.get("stood").map_or(Some(0), |value| value.integer_within(&(0..=longest)));
    let course = table.needed("course").and_then(|value| value.choice(&COURSES));
    let called = name.as_deref().unwrap_or_default();
    // Of a path whose course is invalid, only what every path must keep to is checked; without a map, nothing.
    let path = path::cells(table, called, course.unwrap_or(Course::BackAndForth), drawing);
    table.sound(BlockSpec {
        name: name?,
        dwell: dwell?,
        stood: stood?,
        course: course?,
        path: path?,
        schedule: None,
    })
}

/// A block that is on its first cell, or on its last one, by a schedule.
fn scheduled(table: &Table<'_>, name: &str, drawn: Option<&Drawing>) -> Option<BlockSpec> {
    table.has_none_of(&["dwell", "stood", "course"], "schedule", name)?;
    let (schedule, course) = (schedule(table, name), Course::BackAndForth);
    let path = path::cells(table, name, course, drawn);
    let schedule = schedule?.map(Box::new);
    table.sound(BlockSpec { name: name.to_owned(), dwell: 1, stood: 0, course, path: path?, schedule })
}

/// Records a block that starts on the cell of another block or of the robot. `starts` has the first block on each
/// cell: its name, and the place of the cell in the file.
fn apart(
    table: &Table<'_>,
    block: &BlockSpec,
    starts: &mut BTreeMap<Cell, (String, Range<usize>)>,
    drawing: &Drawing,
) {
    let index = block.start();
    let start = block.path[index];
    if start == drawing.start {
        let what = format!("the robot and the block `{}` start on one cell", block.name);
        let help = "begin the path elsewhere, or draw an `R` where the robot starts";
        table.error::<()>(&what, (table.at_item("path", index), "the robot starts here"), &[], help);
    } else if let Some((first, place)) = starts.get(&start) {
        let what = format!("the blocks `{first}` and `{}` start on one cell", block.name);
        let others = [(place.clone(), "the other one")];
        let help = "begin one of the paths elsewhere";
        table.error::<()>(&what, (table.at_item("path", index), "one starts here"), &others, help);
    } else {
        starts.insert(start, (block.name.clone(), table.at_item("path", index)));
    }
}

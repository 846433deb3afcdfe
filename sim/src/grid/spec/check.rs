//! From the file as written to a world that makes sense.

use super::file::{BlockFile, GridFile, Whole};
use super::map::{Drawing, drawing};
use super::{BlockSpec, Course, GridSpec, MAX_DWELL, MAX_SENSOR_RADIUS, parts, path};
use crate::error::{Source, WorldError};
use serde_spanned::Spanned;
use std::ops::RangeInclusive;

pub(super) fn check(source: &Source<'_>, file: &GridFile) -> Result<GridSpec, WorldError> {
    let name = source.name("", &file.name)?;
    let sensor_radius = whole(source, "sensor_radius", &file.sensor_radius, 1..=MAX_SENSOR_RADIUS)?;
    let drawing = drawing(source, file)?;
    let block_chance = chance(source, "block_chance", &file.transitions.block_chance)?;
    let robot_chance = chance(source, "robot_chance", &file.transitions.robot_chance)?;
    source.unique("block", file.blocks.iter().map(|block| &block.name))?;
    let mut blocks: Vec<BlockSpec> = Vec::new();
    for written in &file.blocks {
        let block = block(source, written, &drawing)?;
        apart(source, file, written, &block, &blocks, &drawing)?;
        blocks.push(block);
    }
    Ok(GridSpec {
        name,
        description: file.description.clone(),
        warnings: parts::warnings(&drawing.walls, drawing.start),
        walls: drawing.walls,
        blocks,
        start: drawing.start,
        sensor_radius,
        block_chance,
        robot_chance,
    })
}

fn block(source: &Source<'_>, file: &BlockFile, drawing: &Drawing) -> Result<BlockSpec, WorldError> {
    let name = source.name("block", &file.name)?;
    let dwell = whole(source, "block.dwell", &file.dwell, 1..=MAX_DWELL)?;
    let stood = match &file.stood {
        Some(stood) => whole(source, "block.stood", stood, 0..=dwell - 1)?,
        None => 0,
    };
    let course = match file.course.get_ref().as_str() {
        "loop" => Course::Loop,
        "back-and-forth" => Course::BackAndForth,
        other => {
            let what = format!("`block.course` is `{other}`, which is not known");
            let help = "it must be \"loop\" or \"back-and-forth\"";
            return Err(source.error(&what, (file.course.span(), "not known"), &[], help));
        }
    };
    Ok(BlockSpec { name, dwell, stood, course, path: path::cells(source, file, course, drawing)? })
}

/// Refuses a block that starts where another one or the robot does.
fn apart(
    source: &Source<'_>,
    file: &GridFile,
    written: &BlockFile,
    block: &BlockSpec,
    others: &[BlockSpec],
    drawing: &Drawing,
) -> Result<(), WorldError> {
    let place = |block: &BlockFile| block.path.get_ref()[0].span();
    let start = block.path[0];
    if start == drawing.start {
        let what = format!("the robot and the block `{}` start on one cell", block.name);
        let help = "begin the path elsewhere, or draw an `R` where the robot starts";
        return Err(source.error(&what, (place(written), "the robot starts here"), &[], help));
    }
    if let Some(other) = others.iter().position(|other| other.path[0] == start) {
        let what = format!("the blocks `{}` and `{}` start on one cell", others[other].name, block.name);
        let marks = [(place(&file.blocks[other]), "the other one")];
        let help = "begin one of the paths elsewhere";
        return Err(source.error(&what, (place(written), "one starts here"), &marks, help));
    }
    Ok(())
}

/// The number, if it is in `range`.
fn whole(
    source: &Source<'_>,
    key: &str,
    value: &Whole,
    range: RangeInclusive<u32>,
) -> Result<u32, WorldError> {
    if let Some(number) = u32::try_from(*value.get_ref()).ok().filter(|number| range.contains(number)) {
        return Ok(number);
    }
    let what = format!("`{key}` is {}, which is out of range", value.get_ref());
    let help = format!("it must be a whole number from {} to {}", range.start(), range.end());
    Err(source.error(&what, (value.span(), "out of range"), &[], &help))
}

/// The chance, if it is one above zero; 1 if it is left out.
fn chance(source: &Source<'_>, key: &str, value: &Option<Spanned<f64>>) -> Result<f64, WorldError> {
    let Some(value) = value else { return Ok(1.0) };
    let number = *value.get_ref();
    if number > 0.0 && number <= 1.0 {
        return Ok(number);
    }
    let what = format!("`transitions.{key}` is {number:?}, which is out of range");
    let help = "it must be a number above 0 and at most 1";
    Err(source.error(&what, (value.span(), "out of range"), &[], help))
}

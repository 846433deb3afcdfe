//! From the file as written to a world that makes sense.

use super::file::{BlockFile, GridFile, TransitionsFile, Whole};
use super::map::{Drawing, drawing};
use super::path;
use crate::error::{Source, WorldError};
use crate::reader::Reading;
use crate::together::Together;
use serde_spanned::Spanned;
use sim::grid::{BlockSpec, Course, GridSpec};
use std::ops::RangeInclusive;

pub(super) fn check(source: &Source<'_>, reading: Reading<GridFile>) -> Result<GridSpec, WorldError> {
    let Reading { file, mut wrong, .. } = reading;
    let files: Vec<&BlockFile> = file.blocks.sound().into_iter().map(Spanned::get_ref).collect();
    let name = file.name.get().and_then(|name| wrong.keep(source.name("", name)));
    let sensor_radius = file.sensor_radius.get().and_then(|radius| {
        wrong.keep(whole(source, "sensor_radius", radius, 1..=GridSpec::MAX_SENSOR_RADIUS))
    });
    let chances = file.transitions.get().map(|transitions| {
        let TransitionsFile { block_chance, robot_chance } = transitions.get_ref();
        let block = wrong.keep(chance(source, "block_chance", block_chance));
        (block, wrong.keep(chance(source, "robot_chance", robot_chance)))
    });
    wrong.keep(source.unique("block", files.iter().map(|block| &block.name)));
    let drawing = file.map.get().and_then(|map| wrong.keep(drawing(source, map)));
    // By their places among the files; none where one is wrong.
    let mut blocks: Vec<Option<BlockSpec>> = Vec::new();
    for written in &files {
        let block = wrong.keep(block(source, written, drawing.as_ref()));
        if let (Some(block), Some(drawing)) = (&block, &drawing) {
            wrong.keep(apart(source, &files, written, block, &blocks, drawing));
        }
        blocks.push(block);
    }
    let (
        Some(name),
        Some(sensor_radius),
        Some((Some(block_probability), Some(robot_probability))),
        Some(drawing),
        true,
    ) = (name, sensor_radius, chances, drawing, wrong.is_empty())
    else {
        return Err(wrong.into_error(source));
    };
    Ok(GridSpec {
        name,
        description: file.description.unwrap_or_default(),
        walls: drawing.walls,
        blocks: blocks.into_iter().flatten().collect(),
        start: drawing.start,
        sensor_radius,
        block_probability,
        robot_probability,
    })
}

fn block(source: &Source<'_>, file: &BlockFile, drawing: Option<&Drawing>) -> Result<BlockSpec, WorldError> {
    let name = source.name("block", &file.name);
    let dwell = whole(source, "block.dwell", &file.dwell, 1..=BlockSpec::MAX_DWELL);
    let longest = dwell.as_ref().map_or(BlockSpec::MAX_DWELL, |dwell| dwell - 1);
    let stood = file.stood.as_ref().map(|stood| whole(source, "block.stood", stood, 0..=longest)).transpose();
    let course = match file.course.get_ref().as_str() {
        "loop" => Ok(Course::Loop),
        "back-and-forth" => Ok(Course::BackAndForth),
        other => {
            let what = format!("`block.course` is `{other}`, which is not known");
            let help = "it must be \"loop\" or \"back-and-forth\"";
            Err(source.error(&what, (file.course.span(), "not known"), &[], help))
        }
    };
    // Without a map there is nothing to judge a path by, and any way round is right if the file has it wrong.
    let way_round = *course.as_ref().unwrap_or(&Course::BackAndForth);
    let path = drawing.map_or(Ok(Vec::new()), |drawing| path::cells(source, file, way_round, drawing));
    let (name, dwell, stood, course, path) = (name, dwell, stood, course, path).together()?;
    Ok(BlockSpec { name, dwell, stood: stood.unwrap_or_default(), course, path })
}

/// Refuses a block that starts where another one or the robot does.
fn apart(
    source: &Source<'_>,
    files: &[&BlockFile],
    written: &BlockFile,
    block: &BlockSpec,
    others: &[Option<BlockSpec>],
    drawing: &Drawing,
) -> Result<(), WorldError> {
    let place = |block: &BlockFile| block.path.get_ref()[0].span();
    let start = block.path[0];
    if start == drawing.start {
        let what = format!("the robot and the block `{}` start on one cell", block.name);
        let help = "begin the path elsewhere, or draw an `R` where the robot starts";
        return Err(source.error(&what, (place(written), "the robot starts here"), &[], help));
    }
    let mut others = others.iter().zip(files);
    let other = others.find(|(other, _)| other.as_ref().is_some_and(|other| other.path[0] == start));
    if let Some((_, other)) = other {
        let what = format!("the blocks `{}` and `{}` start on one cell", other.name.get_ref(), block.name);
        let marks = [(place(other), "the other one")];
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

//! From the file as written to a world that makes sense.

use super::file::{MapFile, ObstacleFile, RobotFile, WallFile, WorldFile};
use super::floor_plan;
use super::numbers::Table;
use super::obstacle::obstacle;
use super::robot::robot;
use super::space::{Around, Solid, inside, upright};
use crate::error::{Source, WorldError, Wrong};
use crate::files::Files;
use crate::reader::Reading;
use crate::together::Together;
use interfaces::GridFrame;
use nalgebra::Point2;
use serde_spanned::Spanned;
use sim::physics::shape::TOUCH_M;
use sim::physics::{DrivenError, FleetSpec, Motion, ObstacleSpec, Rectangle, RobotSpec, WorldSpec};

/// More cells than this are refused before anything is allocated for them.
const MAX_CELLS: f64 = 4e6;
/// Checks everything but who is driven.
pub(super) fn check(
    source: &Source<'_>,
    reading: &Reading<WorldFile>,
    files: &dyn Files,
) -> Result<FleetSpec, WorldError> {
    let file = &reading.file;
    let mut wrong = reading.wrong.clone();
    let name = file.name.get().and_then(|name| wrong.keep(source.name("", name))).unwrap_or_default();
    let physics = Table { source, path: "physics" };
    let step_s = file
        .physics
        .get()
        .and_then(|file| wrong.keep(physics.number_or("step_s", &file.get_ref().step_s, 0.05, 0.001..=0.1)));
    let (size, frame) = file.map.get().map_or((None, None), |file| map(source, file.get_ref(), &mut wrong));
    // Where these are wrong, nothing else is wrong because of them: no map is so large, no step so short.
    let (size, step_s) = (size.unwrap_or(Point2::from([f64::INFINITY; 2])), step_s.unwrap_or(1e-12));
    let misbuilt = wrong.count();
    let mut solids = Vec::new();
    for wall in file.walls.sound() {
        let shape = wrong.keep(self::wall(source, wall, &size));
        solids.extend(shape.map(|shape| Solid { shape, span: wall.span() }));
    }
    for plan in file.floor_plans.sound() {
        let walls = wrong.keep(floor_plan::walls(source, files, plan, &size)).unwrap_or_default();
        solids.extend(walls.into_iter().map(|shape| Solid { shape, span: plan.span() }));
    }
    let walls = solids.iter().map(|wall| wall.shape).collect::<Vec<_>>();
    let mut obstacles = Vec::new();
    let mut movers = Vec::new();
    for file in file.obstacles.sound() {
        let obstacle = obstacle(source, file.get_ref(), &size, &solids[..walls.len()], step_s);
        let Some(obstacle) = wrong.keep(obstacle) else { continue };
        let solid = |shape| Solid { shape, span: file.span() };
        match &obstacle.motion {
            Motion::Fixed if obstacle.appears_s.is_some() => {}
            Motion::Fixed => solids.push(solid(obstacle.shape)),
            Motion::Pushed(_) | Motion::Path(_) | Motion::Door(_) => movers.push(solid(obstacle.start())),
        }
        obstacles.push((file.get_ref(), obstacle));
    }
    let is_whole = reading.is_root_sound
        && file.walls.are_sound()
        && file.floor_plans.are_sound()
        && file.obstacles.are_sound()
        && wrong.count() == misbuilt;
    let around = Around { size, step_s, solids: &solids, movers: &movers, is_whole };
    let mut robots = Vec::new();
    for file in file.robots.sound() {
        let robot = wrong.keep(robot(source, file.get_ref(), &around));
        robots.extend(robot.map(|robot| (file.get_ref(), robot)));
    }
    wrong.keep(source.unique("obstacle", file.obstacles.sound().iter().map(|file| &file.get_ref().name)));
    wrong.keep(source.unique("robot", file.robots.sound().iter().map(|file| &file.get_ref().name)));
    wrong.keep(boxes_apart(source, &obstacles));
    wrong.keep(apart(source, &robots));
    let (Some((frame, turn_rad)), true) = (frame, wrong.is_empty()) else {
        return Err(wrong.into_error(source));
    };

    let description = file.description.clone().unwrap_or_default();
    let obstacles = obstacles.into_iter().map(|(_, obstacle)| obstacle).collect();
    let robots = robots.into_iter().map(|(_, robot)| robot).collect();
    let mut spec = FleetSpec { name, description, frame, step_s, walls, obstacles, robots };
    spec.turn(turn_rad, &(size / 2.0));
    Ok(spec)
}

/// The size of the map (m); the cells that cover it after its turn, and that turn (rad).
fn map(
    source: &Source<'_>,
    file: &MapFile,
    wrong: &mut Wrong,
) -> (Option<Point2<f64>>, Option<(GridFrame, f64)>) {
    let table = Table { source, path: "map" };
    let size = wrong.keep(table.pair("size_m", &file.size_m, 0.1..=1000.0));
    let cell_m = wrong.keep(table.number("cell_m", &file.cell_m, 0.005..=10.0));
    let turn_deg = wrong.keep(table.number_or("turn_deg", &file.turn_deg, 0.0, -360.0..=360.0));
    let (Some(size), Some(cell_m), Some(turn_deg)) = (size, cell_m, turn_deg) else { return (size, None) };
    let turn_rad = turn_deg.to_radians();
    let frame = covering(&size, cell_m, turn_rad).ok_or_else(|| too_many_cells(source, file));
    (Some(size), wrong.keep(frame).map(|frame| (frame, turn_rad)))
}

/// The cells that cover the map after its turn; `None` if they are too many.
fn covering(size: &Point2<f64>, cell_m: f64, turn_rad: f64) -> Option<GridFrame> {
    let half = size.coords / 2.0;
    let (low, high) = Rectangle::around(size / 2.0, half * 2.0, turn_rad).bounds();
    let extent = high - low;
    if (extent.x / cell_m + 1.0) * (extent.y / cell_m + 1.0) > MAX_CELLS {
        return None;
    }
    // Corners that the turn left where they were stay exactly there.
    let exact = |value: f64, plain: f64| if (value - plain).abs() < TOUCH_M { plain } else { value };
    let origin = Point2::new(exact(low.x, 0.0), exact(low.y, 0.0));
    GridFrame::covering(origin, exact(extent.x, size.x), exact(extent.y, size.y), cell_m)
}

fn too_many_cells(source: &Source<'_>, map: &MapFile) -> WorldError {
    source.error(
        "the map has too many cells",
        (map.cell_m.span(), "cells of this size"),
        &[(map.size_m.span(), "on a map of this size")],
        "4 million cells are the most: make the cells larger or the map smaller",
    )
}

fn wall(source: &Source<'_>, file: &Spanned<WallFile>, size: &Point2<f64>) -> Result<Rectangle, WorldError> {
    let table = Table { source, path: "wall" };
    let wall = match file.get_ref() {
        WallFile {
            from_m: Some(from),
            to_m: Some(to),
            thickness_m: Some(thickness),
            min_m: None,
            max_m: None,
        } => {
            let (a, b, thickness_m) = (
                table.point("from_m", from, size),
                table.point("to_m", to, size),
                table.number("thickness_m", thickness, 0.001..=100.0),
            )
                .together()?;
            if (b - a).norm() < 0.001 {
                let marks = [(from.span(), "from here")];
                let help = "the two points must be at least 0.001 m apart";
                return Err(source.error("a wall has no length", (to.span(), "to here"), &marks, help));
            }
            Rectangle::along(a, b, thickness_m)
        }
        WallFile { min_m: Some(min), max_m: Some(max), from_m: None, to_m: None, thickness_m: None } => {
            upright(&table, min, max, size)?
        }
        _ => {
            let help = "give either `from_m`, `to_m` and `thickness_m`, or `min_m` and `max_m`";
            return Err(source.error("a wall needs one shape", (file.span(), "this wall"), &[], help));
        }
    };
    inside(source, "a wall reaches out of the map", file.span(), &wall, size)?;
    Ok(wall)
}

/// Refuses boxes that can be pushed and start in something else: they would burst apart.
fn boxes_apart(source: &Source<'_>, obstacles: &[(&ObstacleFile, ObstacleSpec)]) -> Result<(), WorldError> {
    let is_pushed = |obstacle: &ObstacleSpec| matches!(obstacle.motion, Motion::Pushed(_));
    all_apart(obstacles, |(first_file, first), (file, second)| {
        if !(is_pushed(first) || is_pushed(second)) || !first.start().overlaps(&second.start()) {
            return Ok(());
        }
        let what = format!("the obstacles `{}` and `{}` overlap", first.name, second.name);
        let marks = [(first_file.name.span(), "and this one")];
        let help = "a box that can be pushed may touch other things, but not overlap them";
        Err(source.error(&what, (file.name.span(), "this one"), &marks, help))
    })
}

/// Refuses robots that start in each other.
fn apart(source: &Source<'_>, robots: &[(&RobotFile, RobotSpec)]) -> Result<(), WorldError> {
    all_apart(robots, |(first_file, first), (file, second)| {
        let needed_m = first.radius_m + second.radius_m;
        let apart_m: f64 = (first.pose.translation.vector - second.pose.translation.vector).norm();
        // Circles first: nearly all are far apart.
        if apart_m >= needed_m - TOUCH_M
            || first.form(&first.pose).apart_m(&second.form(&second.pose)) >= -TOUCH_M
        {
            return Ok(());
        }
        let what = format!("the robots `{}` and `{}` overlap", first.name, second.name);
        let marks = [(first_file.pose_m.span(), "the other one")];
        let help = match first.corners.is_empty() && second.corners.is_empty() {
            true => format!("their middles must be {needed_m:.3} m apart or more, not {apart_m:.3} m"),
            false => "their footprints may touch, but not overlap".to_owned(),
        };
        Err(source.error(&what, (file.pose_m.span(), "one stands here"), &marks, &help))
    })
}

/// Compares each with those before it, up to the first that it is not apart from.
fn all_apart<T>(things: &[T], apart: impl Fn(&T, &T) -> Result<(), WorldError>) -> Result<(), WorldError> {
    let each = things
        .iter()
        .enumerate()
        .map(|(i, second)| things[..i].iter().try_for_each(|first| apart(first, second)));
    each.collect::<Vec<_>>().together().map(|_| ())
}

/// The world of a fleet in which exactly one robot is driven.
pub(super) fn world(
    source: &Source<'_>,
    file: &WorldFile,
    fleet: FleetSpec,
) -> Result<WorldSpec, WorldError> {
    let files = file.robots.sound();
    let kind = |i: usize| files[i].get_ref().behaviour.get_ref().kind.span();
    let help = "exactly one robot has `kind = \"driven\"`: the one that explores";
    let has_robots = !fleet.robots.is_empty();
    WorldSpec::new(fleet).map_err(|error| match error {
        DrivenError::None => {
            let mark = if has_robots { kind(0) } else { file.name.get().map_or(0..0, Spanned::span) };
            source.error("no robot is driven", (mark, "not driven"), &[], help)
        }
        DrivenError::Several { first, second } => {
            let marks = [(kind(first), "and so is this one")];
            source.error("more than one robot is driven", (kind(second), "driven"), &marks, help)
        }
    })
}

//! From the tables of a world file to the spec of a world.

use super::behavior;
use super::floor_plan::{self, FloorPlans};
use super::obstacle::{self, obstacle};
use super::robot::{self, robot};
use super::space::{Solid, Solids, Space, inside, upright};
use crate::files::Files;
use crate::reader::{Table, unique_names, valid};
use crate::schedule::starts_s;
use interfaces::GridFrame;
use nalgebra::Point2;
use sim::physics::shape::TOUCH_M;
use sim::physics::{
    BoxTree, ContactModel, DrivenError, FleetSpec, Form, Glass, Motion, ObstacleSpec, Rectangle, RobotSpec,
    ThingPart, WorldSpec,
};
use std::collections::BTreeMap;

/// The models of contacts, the default first.
pub(super) const CONTACTS: [(&str, ContactModel); 2] =
    [("rigid_bodies", ContactModel::RigidBodies), ("sliding", ContactModel::Sliding)];

/// The keys of a world file.
pub(super) const KEYS: &str = "name, description, starts, map, physics, wall, floor_plan, obstacle, robot";

/// The maximum number of cells; more cells are refused before memory is allocated.
const MAX_CELLS: f64 = 4e6;
/// The memory of a run, bytes per cell: 410 for the mapper, 90 for ground truth, planner and agent.
const BYTES_PER_CELL: f64 = 500.0;

/// The fleet that a world file describes, any number of its robots driven.
pub(super) fn fleet(root: &Table<'_>, files: &dyn Files) -> Option<FleetSpec> {
    let name = root.name();
    let description = root.description();
    let (size, frame) =
        root.table("map", "size_m, cell_m, turn_deg").map_or((None, None), |table| map(&table));
    let physics = root.table_or_empty("physics", "step_s, contacts");
    let contacts = physics.as_ref().and_then(|table| table.choice("contacts", &CONTACTS));
    let step_s = physics.and_then(|table| table.sound(table.number_or("step_s", 0.05, 0.001..=0.1)));
    let mut space = Space {
        // If these are invalid, nothing else is invalid because of them: no map is larger, no step shorter.
        size: size.unwrap_or(Point2::from([f64::INFINITY; 2])),
        step_s: step_s.unwrap_or(1e-12),
        walls: Solids::default(),
        fixed: Solids::default(),
        movers: Solids::default(),
        is_whole: false,
    };
    let (mut walls, glass) = walls(root, &space.size);
    let mut plans = FloorPlans::new(files);
    for table in root.tables("floor_plan", floor_plan::KEYS) {
        let pieces = plans.walls(&table, &space.size).unwrap_or_default().into_iter();
        walls.extend(pieces.map(|shape| Solid { shape, span: table.span.clone() }));
    }
    space.walls = Solids::new(walls);
    let obstacle_tables = root.tables("obstacle", obstacle::KEYS);
    let (mut obstacles, mut fixed, mut movers) = (Vec::new(), Vec::new(), Vec::new());
    for table in &obstacle_tables {
        let Some(obstacle) = obstacle(table, &space, &obstacles) else { continue };
        let solid = |shape| Solid { shape, span: table.span.clone() };
        match &obstacle.motion {
            Motion::Fixed | Motion::Scheduled(_) if !obstacle.starts_present() => {}
            Motion::Fixed => fixed.push(solid(obstacle.shape)),
            Motion::Pushed(_) | Motion::Path(_) | Motion::Door(_) | Motion::Scheduled(_) => {
                movers.push(solid(obstacle.start()))
            }
        }
        obstacles.push((table, obstacle));
    }
    join_parts(&mut obstacles);
    (space.fixed, space.movers) = (Solids::new(fixed), Solids::new(movers));
    space.is_whole = root.file.is_sound();
    let robot_tables = root.tables("robot", robot::KEYS);
    let robots = robot_tables.iter().filter_map(|table| Some((table, robot(table, &space)?)));
    let robots: Vec<(&Table<'_>, RobotSpec)> = robots.collect();
    unique_names("obstacle", &obstacle_tables);
    unique_names("robot", &robot_tables);
    boxes_apart(&obstacles);
    let has_calendar = obstacles.iter().any(|(_, obstacle)| obstacle.schedule().is_some())
        || robots.iter().any(|(_, robot)| robot.patrol.is_some());
    let starts_s = starts_s(root, has_calendar);
    apart(&robots);
    let (frame, turn_rad) = frame.filter(|_| root.file.is_sound())?;
    let mut spec = FleetSpec {
        name: name?,
        description: description?,
        frame,
        step_s: space.step_s,
        contacts: contacts?,
        walls: space.walls.solids.iter().map(|solid| solid.shape).collect(),
        glass,
        obstacles: obstacles.into_iter().map(|(_, obstacle)| obstacle).collect(),
        robots: robots.into_iter().map(|(_, robot)| robot).collect(),
        starts_s: starts_s?,
    };
    spec.turn(turn_rad, &(space.size / 2.0));
    Some(spec)
}

/// Tells all parts of a thing, and the obstacle that they are parts of, how many places it has.
fn join_parts(obstacles: &mut [(&Table<'_>, ObstacleSpec)]) {
    let mut places = BTreeMap::new();
    for part in obstacles.iter().filter_map(|(_, obstacle)| obstacle.part) {
        let places = places.entry(part.thing).or_insert(1);
        *places = part.place.max(*places - 1) + 1;
    }
    for (index, (_, obstacle)) in obstacles.iter_mut().enumerate() {
        let (thing, place) = obstacle.part.map_or((index, 0), |part| (part.thing, part.place));
        obstacle.part = places.get(&thing).map(|places| ThingPart { thing, place, places: *places });
    }
}

/// The walls that are tables of their own, and those of them that are glass.
fn walls(root: &Table<'_>, size: &Point2<f64>) -> (Vec<Solid>, Vec<Glass>) {
    let (mut walls, mut glass) = (Vec::new(), Vec::new());
    for table in root.tables("wall", "from_m, to_m, thickness_m, min_m, max_m, returns_within_deg") {
        let shape = wall(&table, size);
        let within_deg = table.number_or("returns_within_deg", 90.0, 0.0..=90.0);
        if let Some(shape) = shape.filter(|_| within_deg < 90.0) {
            glass.push(Glass { shape, returns_within_rad: within_deg.to_radians() });
        }
        walls.extend(shape.map(|shape| Solid { shape, span: table.span }));
    }
    (walls, glass)
}

/// The size of the map (m); the cells that cover it after its turn, and that turn (rad).
fn map(table: &Table<'_>) -> (Option<Point2<f64>>, Option<(GridFrame, f64)>) {
    let size = table.needed("size_m").and_then(|value| value.pair_within(&(0.1..=1000.0)));
    let cell_m = table.number("cell_m", 0.005..=10.0);
    let turn_deg = table.number_or("turn_deg", 0.0, -360.0..=360.0);
    let (Some(size), Some(cell_m), Some(turn_rad)) = (size, valid(cell_m), valid(turn_deg.to_radians()))
    else {
        return (size, None);
    };
    let frame = match covering(&size, cell_m, turn_rad) {
        Ok(frame) => Some((frame, turn_rad)),
        Err(cells) => {
            let (found, most) = (cost(cells), cost(MAX_CELLS));
            let help =
                format!("it has {found}, and {most} are the most: make the cells larger or the map smaller");
            let others = [(table.at("size_m"), "on a map of this size")];
            let mark = (table.at("cell_m"), "cells of this size");
            table.error("the map has too many cells", mark, &others, &help)
        }
    };
    (Some(size), frame)
}

/// The number of cells, and the memory of a run with them.
fn cost(cells: f64) -> String {
    format!("{:.1} million cells (about {:.1} GB of memory)", cells / 1e6, cells * BYTES_PER_CELL / 1e9)
}

/// The cells that cover the map after its turn, or their number if they are too many.
fn covering(size: &Point2<f64>, cell_m: f64, turn_rad: f64) -> Result<GridFrame, f64> {
    let half = size.coords / 2.0;
    let (low, high) = Rectangle::around(size / 2.0, half * 2.0, turn_rad).bounds();
    let extent = high - low;
    let cells = (extent.x / cell_m + 1.0) * (extent.y / cell_m + 1.0);
    if cells > MAX_CELLS {
        return Err(cells);
    }
    // Corners that the turn left where they were stay exactly there.
    let exact = |value: f64, plain: f64| if (value - plain).abs() < TOUCH_M { plain } else { value };
    let origin = Point2::new(exact(low.x, 0.0), exact(low.y, 0.0));
    GridFrame::covering(origin, exact(extent.x, size.x), exact(extent.y, size.y), cell_m).ok_or(cells)
}

fn wall(table: &Table<'_>, size: &Point2<f64>) -> Option<Rectangle> {
    let wall = match ["from_m", "to_m", "thickness_m", "min_m", "max_m"].map(|key| table.has(key)) {
        [true, true, true, false, false] => {
            let [from, to] = ["from_m", "to_m"].map(|key| table.needed(key)?.point(size));
            let thickness_m = table.number("thickness_m", 0.001..=100.0);
            let (from, to, thickness_m) = (from?, to?, valid(thickness_m)?);
            if (to - from).norm() < 0.001 {
                let others = [(table.at("from_m"), "from here")];
                let help = "the two points must be at least 0.001 m apart";
                return table.error("a wall has no length", (table.at("to_m"), "to here"), &others, help);
            }
            Rectangle::along(from, to, thickness_m)
        }
        [false, false, false, true, true] => upright(table, size)?,
        _ => {
            let help = "give either `from_m`, `to_m` and `thickness_m`, or `min_m` and `max_m`";
            return table.error("a wall needs one shape", (table.span.clone(), "this wall"), &[], help);
        }
    };
    inside(table.file, "a wall reaches out of the map", table.span.clone(), &wall, size)?;
    table.sound(wall)
}

/// Records boxes that can be pushed and overlap something else at the start: the physics would throw them apart.
fn boxes_apart(obstacles: &[(&Table<'_>, ObstacleSpec)]) {
    let starts: Vec<Rectangle> = obstacles.iter().map(|(_, obstacle)| obstacle.start()).collect();
    let is_pushed = |i: &usize| matches!(obstacles[*i].1.motion, Motion::Pushed(_));
    let pushed: Vec<usize> = (0..starts.len()).filter(is_pushed).collect();
    let tree_of_all = BoxTree::new(starts.iter().map(Rectangle::bounds));
    let tree_of_pushed = BoxTree::new(pushed.iter().map(|i| starts[*i].bounds()));
    for (i, (table, second)) in obstacles.iter().enumerate() {
        let overlaps = |shape: &Rectangle| shape.overlaps(&starts[i]);
        // Two things that cannot be pushed may overlap.
        let found = if is_pushed(&i) {
            tree_of_all.first_below(i, overlaps, |j| overlaps(&starts[j]))
        } else {
            let before = pushed.partition_point(|j| *j < i);
            tree_of_pushed.first_below(before, overlaps, |j| overlaps(&starts[pushed[j]])).map(|j| pushed[j])
        };
        let Some((other, first)) = found.map(|j| &obstacles[j]) else { continue };
        let what = format!("the obstacles `{}` and `{}` overlap", first.name, second.name);
        let others = [(other.at("name"), "and this one")];
        let help = "a box that can be pushed may touch other things, but not overlap them";
        table.error::<()>(&what, (table.at("name"), "this one"), &others, help);
    }
}

/// Records robots that overlap at the start.
fn apart(robots: &[(&Table<'_>, RobotSpec)]) {
    let forms: Vec<Form> = robots.iter().map(|(_, robot)| robot.form(&robot.pose)).collect();
    let tree = BoxTree::new(forms.iter().map(Form::bounds));
    for (i, (table, second)) in robots.iter().enumerate() {
        let may_overlap = |area: &Rectangle| forms[i].gap_m(&area.corners()) < 0.0;
        let found = tree.first_below(i, may_overlap, |j| forms[j].apart_m(&forms[i]) < -TOUCH_M);
        let Some((other, first)) = found.map(|j| &robots[j]) else { continue };
        let what = format!("the robots `{}` and `{}` overlap", first.name, second.name);
        let apart_m: f64 = (first.pose.translation.vector - second.pose.translation.vector).norm();
        let needed_m = first.radius_m + second.radius_m;
        let help = match first.corners.is_empty() && second.corners.is_empty() {
            true => format!("their middles must be {needed_m:.3} m apart or more, not {apart_m:.3} m"),
            false => "their footprints may touch, but not overlap".to_owned(),
        };
        let others = [(other.at("pose_m"), "the other one")];
        table.error::<()>(&what, (table.at("pose_m"), "one stands here"), &others, &help);
    }
}

/// The world of a fleet in which exactly one robot is driven; `root` is the table that describes the fleet.
pub(super) fn world(root: &Table<'_>, fleet: FleetSpec) -> Option<WorldSpec> {
    let robots = root.tables("robot", robot::KEYS);
    let kind = |robot: &Table<'_>| Some(robot.table("behavior", behavior::KEYS)?.at("kind"));
    let kinds: Vec<_> = robots.iter().filter_map(kind).collect();
    let help = "exactly one robot has `kind = \"driven\"`: the one that explores";
    let world = WorldSpec::new(fleet).map_err(|error| match error {
        DrivenError::None => {
            let mark = kinds.first().cloned().unwrap_or(root.at("name"));
            root.error::<()>("no robot is driven", (mark, "not driven"), &[], help)
        }
        DrivenError::Several { first, second } => {
            let others = [(kinds[first].clone(), "and so is this one")];
            root.error("more than one robot is driven", (kinds[second].clone(), "driven"), &others, help)
        }
    });
    world.ok()
}

//! From the tree of a file to a world.

use super::builder::Builder;
use super::lexer::Span;
use super::pictures::Pictures;
use super::sources::Sources;
use super::tree::Entity;
use super::{Drive, StageRobot, StageWorld, fastest, left_out};
use interfaces::printable;
use nalgebra::Isometry2;
use std::collections::{BTreeMap, BTreeSet};
use worldfile::Severity;

/// More robots than this are an error.
const MAX_ROBOTS: usize = 10_000;
/// The step of Stage, where the file gives none, ms.
const DEFAULT_INTERVAL_SIM_MS: u32 = 100;
/// The physics step is not longer than this, ms.
const MAX_STEP_MS: f64 = 50.0;
/// Nor shorter.
const MIN_STEP_MS: f64 = 1.0;
/// The interval of the laser that a robot without one gets, ms.
const ADDED_LASER_INTERVAL_MS: u32 = 100;

/// Makes the world of a tree. What is left out becomes a warning; there may be errors among the findings even
/// if there is a world.
pub(super) fn convert(sources: &mut Sources<'_>, tree: &Entity) -> Option<StageWorld> {
    if tree.parts.is_empty() && !sources.is_incomplete {
        let help = "it needs things such as `model( … )` and `position( … )`; a file that only defines some is to \
                    be included";
        sources.add_file(Severity::Warning, "there is nothing in this world", help);
    }
    let mut builder = Builder {
        sources,
        length_m: 1.0,
        angle_rad: 1.0_f64.to_radians(),
        interval_sim_ms: DEFAULT_INTERVAL_SIM_MS,
        pictures: Pictures::default(),
        names: BTreeSet::new(),
        generated: BTreeMap::new(),
        walls: Vec::new(),
        tagged: Vec::new(),
        robots: Vec::new(),
    };
    let lengths = [("m", 1.0), ("cm", 0.01), ("mm", 0.001)];
    let length_m = builder.choice(tree, ("unit_length", "unit", "it is one of m, cm, mm"), &lengths);
    let angles = [("degrees", 1.0_f64.to_radians()), ("radians", 1.0)];
    let angle_rad = builder.choice(tree, ("unit_angle", "unit", "it is one of degrees, radians"), &angles);
    builder.length_m = length_m.unwrap_or(builder.length_m);
    builder.angle_rad = angle_rad.unwrap_or(builder.angle_rad);
    let name = builder.text(tree, "name").map(|(name, _)| name);
    let longest_ms = builder.number(tree, "interval_sim", 1.0..=1e5);
    builder.interval_sim_ms = longest_ms.map_or(DEFAULT_INTERVAL_SIM_MS, |ms| ms.round() as u32);
    for model in &tree.parts {
        builder.add(model, &Isometry2::identity(), true);
        if builder.robots.len() > MAX_ROBOTS {
            builder.sources.error(model.place, "too many robots", format!("{MAX_ROBOTS} are the most"));
            return None;
        }
    }
    builder.check_tags();
    let Builder { sources, walls, robots, .. } = builder;
    warn_of_unused(sources, tree);
    let Some(step_s) = step_s(longest_ms, &robots) else {
        let help = "a step may not be shorter than 1 ms, a robot may not go farther than its radius in it, and \
                    sensors sense at whole numbers of steps";
        sources.error(Span::default(), "no physics step suits this world", help);
        return None;
    };
    let file = sources.path().file_stem();
    let file = file.map_or_else(String::new, |stem| printable(&stem.to_string_lossy()).into_owned());
    let name = name.filter(|name| !name.is_empty()).unwrap_or(file);
    Some(StageWorld { name, files: sources.file_names(), step_s, walls, robots })
}

/// A step that is not too long for any robot, and of which the intervals of all sensors are
/// multiples, s.
fn step_s(longest_ms: Option<f64>, robots: &[StageRobot]) -> Option<f64> {
    let given = robots.iter().filter(|robot| robot.lasers.is_empty()).map(|_| ADDED_LASER_INTERVAL_MS);
    let sensors = robots.iter().flat_map(StageRobot::sensors).map(|(_, sensor)| sensor.interval_ms);
    let common_ms = sensors.chain(given).reduce(common_divisor).map_or(MAX_STEP_MS, f64::from);
    let mut longest_ms = longest_ms.unwrap_or(MAX_STEP_MS).min(MAX_STEP_MS);
    for robot in robots {
        let sideways_mps = if robot.drive == Drive::Omni { fastest(robot.velocity.y) } else { 0.0 };
        let fastest_mps = libm::hypot(fastest(robot.velocity.x), sideways_mps);
        // No robot goes farther than its inner radius in a step, so that none can pass through another.
        longest_ms = longest_ms.min(0.999 * 1000.0 * robot.inner_m() / fastest_mps);
    }
    let step_ms = common_ms / (common_ms / longest_ms).ceil().max(1.0);
    (step_ms >= MIN_STEP_MS).then_some(step_ms / 1000.0)
}

fn common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

fn warn_of_unused(sources: &mut Sources<'_>, entity: &Entity) {
    for (name, property) in entity.properties.iter().filter(|(_, property)| !property.is_used.get()) {
        if left_out::has_no_effect(name) {
            sources.has_no_effect(property.name, name);
        } else {
            let what = format!("`{name}` means nothing here");
            sources.warning(property.name, what, left_out::why_unused(name));
        }
        property.is_used.set(true);
    }
    for part in &entity.parts {
        warn_of_unused(sources, part);
    }
}

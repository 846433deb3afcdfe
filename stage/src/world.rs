//! From the tree of a file to a world.

use super::lexer::Span;
use super::sources::Sources;
use super::tree::Entity;
use super::{Drive, StageRobot, StageWorld, fastest, left_out};
use crate::StageWall;
use crate::lexer::{Kind, Token};
use crate::outline::Pictures;
use interfaces::{is_printable, pose, printable};
use nalgebra::{Isometry2, Vector2};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;
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

// Reads the values of keys: their number, their units, their range.

/// The maximum absolute value of lengths, speeds and angles.
const MAX_NUMBER: f64 = 1e5;

/// Makes walls and robots from entities, and reads their keys in the units of the file. If a value is invalid, an
/// error is added and the key counts as missing.
pub(super) struct Builder<'a, 'b> {
    pub(super) sources: &'a mut Sources<'b>,
    /// Meters per unit of length.
    pub(super) length_m: f64,
    /// Radians per unit of angle.
    pub(super) angle_rad: f64,
    /// Stage's own step, ms.
    pub(super) interval_sim_ms: u32,
    pub(super) pictures: Pictures,
    pub(super) names: BTreeSet<String>,
    /// The number of names that were generated, by what they begin with.
    pub(super) generated: BTreeMap<String, usize>,
    pub(super) walls: Vec<StageWall>,
    pub(super) robots: Vec<StageRobot>,
}

impl Builder<'_, '_> {
    /// The numbers of a key.
    pub(super) fn numbers(
        &mut self,
        entity: &Entity,
        name: &str,
        counts: RangeInclusive<usize>,
    ) -> Option<(Vec<f64>, Span)> {
        let property = entity.get(name)?;
        let number = |value: &Token| match value.kind {
            Kind::Number(number) if number.abs() <= MAX_NUMBER => Some(number),
            _ => None,
        };
        let numbers: Option<Vec<f64>> = property.values.iter().map(number).collect();
        if let Some(numbers) = numbers.filter(|numbers| counts.contains(&numbers.len())) {
            return Some((numbers, property.place()));
        }
        let (least, most) = (counts.start(), counts.end());
        let count = if least == most { least.to_string() } else { format!("{least} to {most}") };
        let help = format!("it takes {count} numbers of at most {MAX_NUMBER} each");
        self.sources.error(property.place(), format!("`{name}` has the wrong values"), help);
        None
    }

    /// The numbers of a key that are lengths, m.
    pub(super) fn lengths_m(&mut self, entity: &Entity, name: &str, count: usize) -> Option<Vec<f64>> {
        let (numbers, _) = self.numbers(entity, name, count..=count)?;
        Some(numbers.iter().map(|number| number * self.length_m).collect())
    }

    /// The number of a key, in `range`.
    pub(super) fn number(&mut self, entity: &Entity, name: &str, range: RangeInclusive<f64>) -> Option<f64> {
        let (numbers, place) = self.numbers(entity, name, 1..=1)?;
        if range.contains(&numbers[0]) {
            return Some(numbers[0]);
        }
        let what = format!("`{name}` is {}, which is out of range", numbers[0]);
        let help = format!("it must be a number from {} to {}", range.start(), range.end());
        self.sources.error(place, what, help);
        None
    }

    /// The number of a key that is a length of 0 or more, m.
    pub(super) fn length_m(&mut self, entity: &Entity, name: &str) -> Option<f64> {
        self.number(entity, name, 0.0..=MAX_NUMBER).map(|length| length * self.length_m)
    }

    /// Whether a key is not 0.
    pub(super) fn flag(&mut self, entity: &Entity, name: &str) -> Option<bool> {
        self.number(entity, name, -MAX_NUMBER..=MAX_NUMBER).map(|number| number != 0.0)
    }

    /// The text of a key.
    pub(super) fn text(&mut self, entity: &Entity, name: &str) -> Option<(String, Span)> {
        let property = entity.get(name)?;
        if let [Token { kind: Kind::Text, place }] = property.values.as_slice() {
            let text = self.sources.text(*place);
            if text.chars().all(is_printable) {
                return Some((text.to_owned(), *place));
            }
            let what = format!("`{name}` has a character that is not printable");
            self.sources.error(*place, what, "it takes one line of printable text");
            return None;
        }
        let what = format!("`{name}` has the wrong values");
        self.sources.error(property.place(), what, "it takes one text in quotes");
        None
    }

    /// The meaning of a key that is one of some texts. `what`: what the text names.
    pub(super) fn choice<T: Copy>(
        &mut self,
        entity: &Entity,
        (name, what, help): (&str, &str, &str),
        choices: &[(&str, T)],
    ) -> Option<T> {
        let (text, place) = self.text(entity, name)?;
        let chosen = choices.iter().find(|(choice, _)| *choice == text);
        if chosen.is_none() {
            self.sources.error(place, format!("there is no {what} `{text}`"), help);
        }
        chosen.map(|(_, meaning)| *meaning)
    }

    /// `[x y z heading]` in m and rad, without z; the identity where it is not given.
    pub(super) fn pose(&mut self, entity: &Entity, name: &str) -> Isometry2<f64> {
        let Some((mut numbers, place)) = self.numbers(entity, name, 2..=4) else {
            return Isometry2::identity();
        };
        let count = numbers.len();
        if count < 4 {
            let what = format!("`{name}` has {count} numbers");
            if numbers.get(2).is_some_and(|third| *third != 0.0) {
                // Old files mean the heading by it, newer ones the height.
                let help = "it takes 4: x, y, z, and the heading, which is the fourth";
                self.sources.error(place, what, help);
                return Isometry2::identity();
            }
            let help = "it takes 4: x, y, z and heading; Stage 4.3 refuses this, here the others are 0";
            self.sources.warning(place, what, help);
            numbers.resize(4, 0.0);
        }
        if numbers[2] != 0.0 {
            self.sources.has_no_effect(place, "pose z");
        }
        let (m, rad) = (self.length_m, self.angle_rad);
        pose(numbers[0] * m, numbers[1] * m, numbers[3] * rad)
    }

    /// `[x y z]` in m, without z, which may be left out.
    pub(super) fn size_m(&mut self, entity: &Entity, default_m: f64) -> Vector2<f64> {
        let Some((numbers, place)) = self.numbers(entity, "size", 2..=3) else {
            return Vector2::repeat(default_m);
        };
        let size_m = Vector2::new(numbers[0], numbers[1]) * self.length_m;
        if size_m.min() < 1e-4 {
            let help = "it takes x, y and z, each above 0.0001 m";
            self.sources.error(place, "`size` is not positive", help);
            return Vector2::repeat(default_m);
        }
        size_m
    }
}

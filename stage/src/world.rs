//! From the tree of things to walls and robots.

use super::body::Body;
use super::heights::{Heights, Solid};
use super::known;
use super::pictures::Pictures;
use super::place::Place;
use super::sources::Sources;
use super::step;
use super::tree::Thing;
use super::values::{Pose, Reader};
use super::{StageRobot, StageWall, StageWorld, tags};
use nalgebra::Point2;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use worldfile::Files;
use worldfile::Severity;

/// More robots than this are an error.
const MAX_ROBOTS: usize = 10_000;
/// The size of a model, where the file gives none, m.
pub(super) const DEFAULT_SIZE_M: [f64; 3] = [0.1; 3];

/// The step of Stage, where the file gives none, ms.
const DEFAULT_INTERVAL_SIM_MS: u32 = 100;

/// Makes walls and robots of things.
pub(super) struct Builder<'a, 'b> {
    pub(super) reader: Reader<'a, 'b>,
    pub(super) names: BTreeSet<String>,
    /// How many names of each kind were made up.
    pub(super) made_up: BTreeMap<String, usize>,
    walls: Vec<StageWall>,
    /// The walls that have a tag, with their pose and where the file speaks of the tag.
    tagged: Vec<(usize, Point2<f64>, Place)>,
    pub(super) robots: Vec<StageRobot>,
    pub(super) heights: Heights,
}

/// Makes the world of a tree. What it leaves out it names; whether there were errors is for the
/// caller to see.
pub(super) fn convert(
    sources: &mut Sources<'_>,
    path: &Path,
    files: &dyn Files,
    tree: &Thing,
) -> Option<StageWorld> {
    if tree.parts.is_empty() && !sources.is_incomplete {
        let help = "it needs things such as `model( … )` and `position( … )`; a file that only defines some is to \
                    be included";
        sources.findings.add_file(Severity::Warning, path, "there is nothing in this world", help);
    }
    let mut reader = Reader {
        sources,
        length_m: 1.0,
        angle_rad: 1.0_f64.to_radians(),
        interval_sim_ms: DEFAULT_INTERVAL_SIM_MS,
        pictures: Pictures::new(files),
    };
    reader.units(tree);
    let name = reader.text(tree, "name").map(|(name, _)| name);
    let quit_time_s = reader.number(tree, "quit_time", 0.0..=1e5).filter(|time_s| *time_s > 0.0);
    let longest_ms = reader.number(tree, "interval_sim", 1.0..=1e5);
    reader.interval_sim_ms = longest_ms.map_or(DEFAULT_INTERVAL_SIM_MS, |ms| ms.round() as u32);
    let mut builder = Builder {
        reader,
        names: BTreeSet::new(),
        made_up: BTreeMap::new(),
        walls: Vec::new(),
        tagged: Vec::new(),
        robots: Vec::new(),
        heights: Heights::default(),
    };
    for thing in &tree.parts {
        builder.stands(thing, &Pose::origin(), true);
        if builder.robots.len() > MAX_ROBOTS {
            let help = format!("{MAX_ROBOTS} are the most");
            builder.reader.sources.error(thing.place, "too many robots", "", &help);
            return None;
        }
    }
    tags::check(builder.reader.sources, &mut builder.walls, &builder.tagged);
    builder.heights.compare(builder.reader.sources);
    builder.warn_of_unused(tree);
    let step_s = step::step_s(builder.reader.sources, longest_ms, &builder.robots)?;
    let file_name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    Some(StageWorld {
        name: name.filter(|name| !name.is_empty()).unwrap_or(file_name),
        files: builder.reader.sources.file_names().map(str::to_owned).collect(),
        step_s,
        quit_time_s,
        walls: builder.walls,
        robots: builder.robots,
    })
}

impl Reader<'_, '_> {
    fn units(&mut self, world: &Thing) {
        let mut unit = |name: &str, units: &[(&str, f64)]| {
            let (unit, place) = self.text(world, name)?;
            let known = units.iter().find(|(known, _)| *known == unit);
            if known.is_none() {
                let names: Vec<&str> = units.iter().map(|(name, _)| *name).collect();
                self.sources.error(
                    place,
                    &format!("there is no unit `{unit}`"),
                    "",
                    &format!("it is one of {}", names.join(", ")),
                );
            }
            known.map(|(_, value)| *value)
        };
        let length = unit("unit_length", &[("m", 1.0), ("cm", 0.01), ("mm", 0.001)]);
        let angle = unit("unit_angle", &[("degrees", 1.0_f64.to_radians()), ("radians", 1.0)]);
        self.length_m = length.unwrap_or(self.length_m);
        self.angle_rad = angle.unwrap_or(self.angle_rad);
    }
}

impl Builder<'_, '_> {
    /// A thing that stands on the floor or on another one that does.
    fn stands(&mut self, thing: &Thing, on: &Pose, is_first: bool) {
        match thing.kind.as_str() {
            "position" if is_first => self.robot(thing),
            "position" => {
                let help = "here it is a part of that thing; put it at the top level to let it drive";
                self.reader.sources.warning(thing.place, "a robot on another thing", "", help);
                self.wall(thing, on);
            }
            "model" | "puck" => self.wall(thing, on),
            "ranger" | "laser" => {
                let help = "only robots have lasers here";
                self.left_out(thing, "a laser that stands alone is left out", help);
            }
            "fiducial" => {
                let help = "only robots have fiducial finders here";
                self.left_out(thing, "a fiducial finder that stands alone is left out", help);
            }
            _ => self.other(thing),
        }
    }

    /// A kind of thing that is neither a wall nor a robot.
    pub(super) fn other(&mut self, thing: &Thing) {
        let kind = thing.kind.as_str();
        if known::is_harmless(kind) {
            self.reader.sources.harmless(thing.place, kind);
            return use_all(thing);
        }
        if let Some((_, why)) = known::KINDS_LEFT_OUT.iter().find(|(known, _)| *known == kind) {
            return self.left_out(thing, &format!("`{kind}` is left out"), why);
        }
        let (what, help) = match kind {
            "block" => ("a block outside of a thing", "it belongs into the ( ) of a model or robot"),
            "sensor" => ("a sensor outside of a ranger", "it belongs into the ( ) of a `ranger`"),
            // It may be defined in what could not be read.
            _ if self.reader.sources.is_incomplete => return use_all(thing),
            _ => (
                "an unknown kind of thing",
                "Stage knows no such model; is the `include` of its `define` missing?",
            ),
        };
        self.reader.sources.error(thing.place, what, "", help);
        use_all(thing);
    }

    pub(super) fn left_out(&mut self, thing: &Thing, what: &str, why: &str) {
        self.reader.sources.warning(thing.place, what, "", why);
        use_all(thing);
    }

    /// The pose of a thing on another one, its body, and the place on top of it for its parts.
    pub(super) fn place(
        &mut self,
        thing: &Thing,
        on: &Pose,
        default_size_m: [f64; 3],
        has_box: bool,
    ) -> (Pose, Body, Pose) {
        let own = self.reader.pose(thing, "pose").unwrap_or(Pose::origin());
        let at = on.then(&own);
        let size_m = self.reader.size(thing, default_size_m);
        let body = self.reader.body(thing, &at, size_m, has_box);
        let stacks = self.reader.flag(thing, "stack_children").unwrap_or(true);
        let top = Pose { z_m: at.z_m + if stacks { size_m[2] } else { 0.0 }, ..at };
        (at, body, top)
    }

    fn wall(&mut self, thing: &Thing, on: &Pose) {
        let looks = self.looks(thing);
        let (at, body, top) = self.place(thing, on, DEFAULT_SIZE_M, true);
        if let Some((_, place)) = self.reader.text(thing, "ctrl") {
            self.reader.sources.warning(
                place,
                "controllers of Stage cannot be loaded",
                "",
                "this thing stands still",
            );
        }
        self.warn_of_half_ghost(thing, &looks, &body);
        let has_body = looks.is_there() && !body.is_empty();
        if let Some((_, place)) = looks.tag.filter(|_| !has_body) {
            let help = "only what robots bump into has a tag here";
            self.reader.sources.warning(place, "the tag of a thing without a body is left out", "", help);
        }
        if has_body {
            let (rectangles, off_m) = body.rectangles();
            self.warn_of_cover(thing, off_m);
            self.heights.solids.push(Solid {
                name: looks.name.clone(),
                robot: None,
                place: thing.place,
                z_m: body.z_m,
            });
            if let Some((_, place)) = looks.tag {
                self.tagged.push((self.walls.len(), at.flat.translation.vector.into(), place));
            }
            self.walls.push(StageWall {
                name: looks.name,
                color: looks.color,
                place: self.reader.sources.name(thing.place),
                plan: body.plan,
                rectangles,
                tag: looks.tag.map(|(tag, _)| tag),
                at: thing.place,
            });
        }
        for part in thing.parts.iter().filter(|part| part.kind != "block") {
            self.stands(part, &top, false);
        }
    }

    fn warn_of_cover(&mut self, thing: &Thing, off_m: f64) {
        if off_m == f64::INFINITY {
            let help = "a block without area is left out; give it three corners that are not on a line";
            self.reader.sources.warning(thing.place, "a block without area", "", help);
        } else if off_m > 1e-6 {
            let what = format!("sharp corners of this thing are cut off, by up to {off_m:.3} m");
            let help = "walls here are made of rectangles, which do not fill a corner of less than 90°";
            self.reader.sources.warning(thing.place, &what, "", help);
        }
    }

    fn warn_of_unused(&mut self, thing: &Thing) {
        for (name, property) in thing.properties.iter().filter(|(_, property)| !property.is_used.get()) {
            if known::is_harmless(name) {
                self.reader.sources.harmless(property.name, name);
            } else {
                let what = format!("`{name}` means nothing here");
                self.reader.sources.warning(property.name, &what, "", known::why_unused(name));
            }
            property.is_used.set(true);
        }
        for part in &thing.parts {
            self.warn_of_unused(part);
        }
    }
}

/// Nothing in this thing shall be named again.
fn use_all(thing: &Thing) {
    thing.properties.values().for_each(|property| property.is_used.set(true));
    thing.parts.iter().for_each(use_all);
}

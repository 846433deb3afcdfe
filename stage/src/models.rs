//! Models: their names, their bodies, and those that are walls.

use super::tree::Entity;
use super::{StageWall, left_out};
use crate::body::Body;
use crate::world::Builder;
use nalgebra::Isometry2;
use worldfile::Severity;

/// The length and the width of a model, where the file gives none, m.
pub(super) const DEFAULT_SIZE_M: f64 = 0.1;

/// A model at its pose.
pub(super) struct Placed {
    pub(super) name: String,
    /// Whether robots bump into it or lasers see it.
    pub(super) is_solid: bool,
    pub(super) at: Isometry2<f64>,
    pub(super) body: Body,
}

impl Builder<'_, '_> {
    /// A model on another one or on the floor. `has_box`: without blocks or a bitmap it is a box.
    pub(super) fn placed(
        &mut self,
        model: &Entity,
        on: &Isometry2<f64>,
        default_size_m: f64,
        has_box: bool,
    ) -> Placed {
        let name = self.name(model);
        let collides = self.flag(model, "obstacle_return").unwrap_or(true);
        let by_rangers = self.number(model, "ranger_return", -1e5..=1e5).is_none_or(|value| value >= 0.0);
        let by_lasers = self.flag(model, "laser_return").unwrap_or(true);
        let is_seen = by_rangers && by_lasers;
        if let Some((_, place)) = self.numbers(model, "mass", 1..=1).filter(|_| model.kind != "position") {
            let help = "robots push nothing in Stage, and no walls here; in a world file of ours they push an \
                        `[[obstacle]]` of `kind = \"box\"`";
            let what = "the `mass` of what is no robot changes nothing";
            self.sources.add(Severity::Note, place, what, help);
        }
        let at = on * self.pose(model, "pose");
        let size_m = self.size_m(model, default_size_m);
        let body = self.body(model, &at, size_m, has_box);
        if collides != is_seen && !body.is_empty() {
            let (what, help) = match collides {
                true => ("this thing cannot be seen in Stage", "here lasers see whatever robots bump into"),
                false => {
                    ("nothing bumps into this thing in Stage", "here robots bump into whatever lasers see")
                }
            };
            self.sources.warning(model.place, what, help);
        }
        Placed { name, is_solid: collides || is_seen, at, body }
    }

    /// A name that no other model has.
    fn name(&mut self, model: &Entity) -> String {
        let given = self.text(model, "name");
        let mut name = given.as_ref().map_or_else(|| model.kind.clone(), |(name, _)| name.clone());
        if given.is_none() || self.names.contains(&name) {
            // As Stage generates names.
            let count = self.generated.entry(name.clone()).or_default();
            let mut free = format!("{name}:{count}");
            while self.names.contains(&free) {
                *count += 1;
                free = format!("{name}:{count}");
            }
            *count += 1;
            if let Some((_, place)) = given {
                let help = format!("this one is called `{free}` here");
                self.sources.warning(place, format!("two things are called `{name}`"), help);
            }
            name = free;
        }
        self.names.insert(name.clone());
        name
    }

    /// Adds a model that stands on the floor or on another one that does.
    pub(super) fn add(&mut self, model: &Entity, on: &Isometry2<f64>, is_first: bool) {
        match model.kind.as_str() {
            "position" if is_first => self.robot(model),
            "position" => {
                let help = "here it is a part of that thing; put it at the top level to let it drive";
                self.sources.warning(model.place, "a robot on another thing", help);
                self.wall(model, on);
            }
            "model" | "puck" => self.wall(model, on),
            "ranger" | "laser" => {
                let what = "a sensor that stands alone is left out";
                self.left_out(model, what, "only robots have sensors here");
            }
            _ => self.other(model),
        }
    }

    fn wall(&mut self, model: &Entity, on: &Isometry2<f64>) {
        let Placed { name, is_solid, at, body } = self.placed(model, on, DEFAULT_SIZE_M, true);
        if let Some((_, place)) = self.text(model, "ctrl") {
            let what = "controllers of Stage cannot be loaded";
            self.sources.warning(place, what, "this thing stands still");
        }
        if is_solid && !body.is_empty() {
            let (rectangles, off_m) = body.rectangles();
            if off_m == f64::INFINITY {
                let help = "a block without area is left out; give it three corners that are not on a line";
                self.sources.warning(model.place, "a block without area", help);
            } else if off_m > 1e-6 {
                let what = format!("sharp corners of this thing are cut off, by up to {off_m:.3} m");
                let help = "walls here are made of rectangles, which do not fill a corner of less than 90°";
                self.sources.warning(model.place, what, help);
            }
            let place = self.sources.name(model.place);
            self.walls.push(StageWall { name, place, rectangles, at: model.place });
        }
        for part in model.carried() {
            self.add(part, &at, false);
        }
    }

    /// An entity that is neither a wall nor a robot.
    pub(super) fn other(&mut self, entity: &Entity) {
        let kind = entity.kind.as_str();
        if left_out::has_no_effect(kind) {
            self.sources.has_no_effect(entity.place, kind);
            return use_all(entity);
        }
        if let Some(why) = left_out::why_not_here(kind) {
            return self.left_out(entity, &format!("`{kind}` is left out"), why);
        }
        let (what, help) = match kind {
            "block" => ("a block outside of a thing", "it belongs into the ( ) of a model or robot"),
            "sensor" => ("a sensor outside of a ranger", "it belongs into the ( ) of a `ranger`"),
            // It may be defined in what could not be read.
            _ if self.sources.is_incomplete => return use_all(entity),
            _ => (
                "an unknown kind of thing",
                "Stage knows no such model; is the `include` of its `define` missing?",
            ),
        };
        self.sources.error(entity.place, what, help);
        use_all(entity);
    }

    pub(super) fn left_out(&mut self, entity: &Entity, what: &str, why: &str) {
        self.sources.warning(entity.place, what, why);
        use_all(entity);
    }
}

/// Marks all keys as used: nothing of this entity shall be reported again.
fn use_all(entity: &Entity) {
    entity.properties.values().for_each(|property| property.is_used.set(true));
    entity.parts.iter().for_each(use_all);
}

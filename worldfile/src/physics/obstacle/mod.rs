//! An obstacle: its kind, its shape and its motion.

mod block;
mod door;

use crate::physics::kind::{KindOf, kind_of};
use crate::physics::space::{MAX_TIME_S, Space, inside, upright};
use crate::reader::{Table, valid};
use crate::schedule::schedule;
use calendar::Schedule;
use sim::physics::{Motion, ObstacleSpec, PushedSpec, Rectangle, ThingPart};

pub(super) const KEYS: &str = "name, kind, min_m, max_m, center_m, size_m, heading_deg, appears_s, \
                               disappears_s, part_of, place, mass_kg, friction, path_m, dwell_s, speed_mps, times_s, repeat, \
                               from_m, to_m, thickness_m, open_deg, slide_m, opening, closed_s, open_s, \
                               switches_s, move_s, starts_open, schedule, waits_for_robots";

/// The largest number of places of a thing.
const MAX_PLACES: u32 = 100;

/// The kinds of obstacles; all have a name and a kind as well.
const KINDS: [KindOf; 5] = [
    (
        "fixed",
        "min_m, max_m, center_m, size_m, heading_deg, appears_s, disappears_s, schedule, part_of, place",
        "stands, and may come and go",
    ),
    ("box", "min_m, max_m, center_m, size_m, heading_deg, mass_kg, friction", "can be pushed"),
    ("block", "size_m, heading_deg, path_m, dwell_s, speed_mps, times_s, repeat", "moves along a path"),
    (
        "hinged_door",
        "from_m, to_m, thickness_m, open_deg, opening, closed_s, open_s, switches_s, move_s, starts_open, schedule, \
         waits_for_robots",
        "turns about `from_m`",
    ),
    (
        "sliding_door",
        "from_m, to_m, thickness_m, slide_m, opening, closed_s, open_s, switches_s, move_s, starts_open, schedule, \
         waits_for_robots",
        "slides from `to_m` towards `from_m`",
    ),
];

/// An obstacle of the file, and its surroundings.
struct Obstacle<'a> {
    table: &'a Table<'a>,
    name: &'a str,
    space: &'a Space,
    /// The obstacles before it in the file.
    before: &'a [(&'a Table<'a>, ObstacleSpec)],
}

/// The obstacle of a table, after those `before` it in the file.
pub(super) fn obstacle<'a>(
    table: &'a Table<'a>,
    space: &'a Space,
    before: &'a [(&'a Table<'a>, ObstacleSpec)],
) -> Option<ObstacleSpec> {
    let name = table.name();
    let kind = kind_of(table, &KINDS, "an obstacle")?;
    let obstacle = Obstacle { table, name: name.as_deref().unwrap_or_default(), space, before };
    let spec = match kind {
        "block" => obstacle.block(),
        "hinged_door" | "sliding_door" => obstacle.door(kind == "hinged_door"),
        "box" => obstacle.pushed(),
        _ => obstacle.fixed(),
    };
    table.sound(ObstacleSpec { name: name?, ..spec? })
}

impl Obstacle<'_> {
    /// Records an error about the obstacle as a whole.
    fn error<T>(&self, what: &str, help: &str) -> Option<T> {
        self.table.error(what, (self.table.at("name"), "this one"), &[], help)
    }

    fn incomplete<T>(&self, what: &str, help: &str) -> Option<T> {
        self.error(&format!("the {what} `{}` is not complete", self.name), help)
    }

    fn heading_rad(&self) -> Option<f64> {
        valid(self.table.number_or("heading_deg", 0.0, -360.0..=360.0).to_radians())
    }

    fn fixed(self) -> Option<ObstacleSpec> {
        let (shape, times_s) = (self.shape(), self.stay_s());
        if self.table.has("part_of") || self.table.has("place") {
            let (part, schedule) = self.part()?;
            let motion = Motion::Scheduled(Box::new(schedule));
            return Some(ObstacleSpec { part: Some(part), ..ObstacleSpec::new(self.name, shape?, motion) });
        }
        let schedule = self.schedule(&["appears_s", "disappears_s"])?;
        let [appears_s, disappears_s] = times_s?;
        if let Some(schedule) = schedule {
            return Some(ObstacleSpec::new(self.name, shape?, Motion::Scheduled(Box::new(schedule))));
        }
        Some(ObstacleSpec { appears_s, disappears_s, ..ObstacleSpec::new(self.name, shape?, Motion::Fixed) })
    }

    /// The schedule of the obstacle, `Some(None)` if it has none. `others` are the keys that a schedule replaces.
    fn schedule(&self, others: &[&'static str]) -> Option<Option<Schedule>> {
        let schedule = schedule(self.table, self.name)?;
        if schedule.is_some() {
            self.table.has_none_of(others, "schedule", self.name)?;
        }
        Some(schedule)
    }

    /// The thing that the obstacle is a part of, with its schedule. The number of its places is not known yet.
    fn part(&self) -> Option<(ThingPart, Schedule)> {
        let table = self.table;
        table.has_none_of(&["appears_s", "disappears_s", "schedule"], "part_of", self.name)?;
        let place = table.get("place").map_or(Some(1), |place| place.integer_within(&(1..=MAX_PLACES)))?;
        let name = table.get("part_of").map_or(Some(""), |name| name.text())?;
        let is_thing = |other: &ObstacleSpec| other.name == name && other.part.is_none();
        let thing = self.before.iter().position(|(_, other)| is_thing(other));
        match thing.map(|thing| (thing, &self.before[thing].1.motion)) {
            Some((thing, Motion::Scheduled(schedule))) => {
                let place = place as usize - 1;
                Some((ThingPart { thing, place, places: 1 }, (**schedule).clone()))
            }
            // It can be missing since it is invalid itself.
            _ if !table.file.is_sound() => None,
            _ => {
                let what = format!("the obstacle `{}` is a part of no thing", self.name);
                let help = "`part_of` names an obstacle before it that has a schedule and is no part itself";
                self.error(&what, help)
            }
        }
    }

    /// When the obstacle appears and disappears, s.
    fn stay_s(&self) -> Option<[Option<f64>; 2]> {
        let times_s = ["appears_s", "disappears_s"];
        let times_s = times_s.map(|key| self.table.number_if(key, 0.001..=MAX_TIME_S));
        if let [Some(from), Some(to)] = times_s
            && to <= from
        {
            let what = format!("the obstacle `{}` disappears before it appears", self.name);
            let help = format!("`disappears_s` must be later than `appears_s`, which is {from}");
            return self.table.error(&what, (self.table.at("disappears_s"), "too early"), &[], &help);
        }
        Some(times_s)
    }

    fn pushed(self) -> Option<ObstacleSpec> {
        let shape = self.shape();
        let mass_kg = self.table.needed("mass_kg").and_then(|mass| mass.within(&(0.001..=100_000.0)));
        let friction = self.table.number_or("friction", 0.5, 0.0..=10.0);
        let shape = shape?;
        // A thin box would lie in a wall as a whole before the physics pushes it out.
        if shape.half_m.min() < 0.01 {
            let help = "a box that can be pushed must be 0.02 m wide or more";
            return self.error(&format!("the box `{}` is too thin", self.name), help);
        }
        Some(ObstacleSpec::new(self.name, shape, Motion::Pushed(PushedSpec { mass_kg: mass_kg?, friction })))
    }

    /// The shape of an obstacle that stands at the start: in the map and in no wall.
    fn shape(&self) -> Option<Rectangle> {
        let (table, size) = (self.table, &self.space.size);
        let has = |key| table.has(key);
        let shape = match ["min_m", "max_m", "center_m", "size_m"].map(has) {
            [true, true, false, false] if !has("heading_deg") => upright(table, size)?,
            [false, false, true, true] => {
                let center = table.get("center_m")?.point(size);
                let sides = table.get("size_m")?.pair_within(&(0.001..=100.0));
                let heading_rad = self.heading_rad();
                Rectangle::around(center?, sides?.coords, heading_rad?)
            }
            _ => {
                let mark = (table.at("name"), "this obstacle");
                let help = "give either `min_m` and `max_m`, or `center_m`, `size_m` and, if it is turned, `heading_deg`";
                return table.error("an obstacle needs one shape", mark, &[], help);
            }
        };
        let what = format!("the obstacle `{}` reaches out of the map", self.name);
        inside(table.file, &what, table.at("name"), &shape, size)?;
        if let Some(wall) = self.space.walls.first(|wall| wall.overlaps(&shape)) {
            let what = format!("the obstacle `{}` stands in a wall", self.name);
            let others = [(wall.span.clone(), "in this wall")];
            let help = "it may touch walls, but not overlap them";
            return table.error(&what, (table.at("name"), "this obstacle"), &others, help);
        }
        Some(shape)
    }

    /// The fastest that a surface may move, m/s: 0.1 m in a physics step.
    fn fastest_mps(&self) -> f64 {
        0.1 / self.space.step_s
    }
}

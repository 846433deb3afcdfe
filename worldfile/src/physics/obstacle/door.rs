//! A door: its leaf, and the times at which it opens.

use super::Obstacle;
use crate::physics::space::{MAX_TIME_S, inside};
use sim::physics::{DoorSpec, Leaf, Motion, ObstacleSpec, Opening, Rectangle};

const MAX_SWITCHES: usize = 100_000;
/// An opening by the times for which the door is closed and open, s.
type Stays = fn(f64, f64) -> Opening;

/// The openings; a scripted door has other times.
const OPENINGS: [(&str, Option<Stays>); 3] = [
    ("periodic", Some(|closed_s, open_s| Opening::Periodic { closed_s, open_s })),
    ("random", Some(|closed_s, open_s| Opening::Random { closed_s, open_s })),
    ("scripted", None),
];

impl Obstacle<'_> {
    pub(super) fn door(self, is_hinged: bool) -> Option<ObstacleSpec> {
        let table = self.table;
        let [from, to] = ["from_m", "to_m"].map(|key| table.needed(key)?.point(&self.space.size));
        let thickness_m = table.needed("thickness_m").and_then(|value| value.within(&(0.01..=1.0)));
        let open_deg = table.number_or("open_deg", 90.0, -180.0..=180.0);
        let slide_m = table.number_if("slide_m", -10.0..=10.0);
        let move_s = table.number_or("move_s", 1.0, 0.05..=3600.0);
        let opening = self.opening();
        let starts_open = match &opening {
            Some(Opening::Scheduled { schedule, .. }) => !schedule.starts_blocked,
            _ => table.flag("starts_open"),
        };
        let (from, to, thickness_m) = (from?, to?, thickness_m?);
        let length_m = (to - from).norm();
        if !(0.1..=10.0).contains(&length_m) {
            let what = format!("the leaf of `{}` is {length_m:.3} m long", self.name);
            let others = [(table.at("from_m"), "from here")];
            return table.error(&what, (table.at("to_m"), "to here"), &others, "it must be 0.1 to 10 m long");
        }
        let shape = Rectangle::along(from, to, thickness_m);
        let what = format!("the leaf of `{}` reaches out of the map", self.name);
        let is_inside = inside(table.file, &what, table.at("name"), &shape, &self.space.size);
        let (leaf, travel_m) = if is_hinged {
            let open_rad = open_deg.to_radians();
            (Leaf::Hinged { hinge: from, open_rad }, open_rad.abs() * length_m)
        } else {
            let slide_m = slide_m.unwrap_or(length_m);
            (Leaf::Sliding { by_m: (from - to) / length_m * slide_m }, slide_m.abs())
        };
        // In one step no point of the leaf moves farther than what the physics keeps apart.
        if travel_m / move_s > self.fastest_mps() {
            let what = format!("the leaf of `{}` moves at {:.3} m/s", self.name, travel_m / move_s);
            let help = format!("`move_s` must be {:.3} or more", travel_m / self.fastest_mps());
            let key = if table.has("move_s") { "move_s" } else { "name" };
            return table.error(&what, (table.at(key), "too fast"), &[], &help);
        }
        is_inside?;
        let door = DoorSpec { leaf, opening: opening?, move_s, starts_open };
        Some(ObstacleSpec::new(self.name, shape, Motion::Door(door)))
    }

    fn opening(&self) -> Option<Opening> {
        let table = self.table;
        if let Some(schedule) =
            self.schedule(&["opening", "closed_s", "open_s", "switches_s", "starts_open"])?
        {
            let waits_for_robots = table.flag("waits_for_robots");
            return Some(Opening::Scheduled { schedule: Box::new(schedule), waits_for_robots });
        }
        if table.flag("waits_for_robots") {
            let what = format!("the door `{}` has no schedule", self.name);
            let help = "only a door with a `schedule` waits for robots";
            return table.error(&what, (table.at("waits_for_robots"), "this door"), &[], help);
        }
        let Some(kind) = table.get("opening") else {
            let help = "it needs an `opening`, \"periodic\", \"random\" or \"scripted\", or a `schedule`";
            return self.incomplete("door", help);
        };
        let opening = kind.choice(&OPENINGS)?;
        match (opening, ["closed_s", "open_s", "switches_s"].map(|key| table.has(key))) {
            (Some(opening), [true, true, false]) => {
                let times_s = ["closed_s", "open_s"].map(|key| table.number(key, 0.1..=MAX_TIME_S));
                Some(opening(times_s[0], times_s[1]))
            }
            (None, [false, false, true]) => self.script(),
            _ => {
                let what = format!("the opening of `{}` does not fit its times", self.name);
                let help = match opening {
                    None => "a scripted door has `switches_s`: the times at which it opens, closes, opens, …",
                    Some(_) => {
                        "such a door has `closed_s` and `open_s`: how long it stays so, or the means of that"
                    }
                };
                table.error(&what, (kind.span(), "this opening"), &[], help)
            }
        }
    }

    /// The times at which a scripted door opens, closes, opens, ….
    fn script(&self) -> Option<Opening> {
        let table = self.table;
        let switches = table.get("switches_s")?;
        if switches.items()?.len() > MAX_SWITCHES {
            let what = format!("the door `{}` switches too often", self.name);
            let help = format!("{MAX_SWITCHES} times are the most");
            return table.error(&what, (switches.span(), "these times"), &[], &help);
        }
        let switches_s = switches.list(|time| time.within(&(0.0..=MAX_TIME_S)))?;
        if let Some(early) = switches_s.windows(2).position(|pair| pair[1] <= pair[0]) {
            let mark = (table.at_item("switches_s", early + 1), "too early");
            let help = "each time must be later than the one before";
            return table.error("`obstacle.switches_s` is not in order", mark, &[], help);
        }
        Some(Opening::Scripted { switches_s })
    }
}

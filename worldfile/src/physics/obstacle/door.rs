//! A door: its leaf, and when it opens.

use super::Context;
use crate::error::WorldError;
use crate::physics::file::Number;
use crate::physics::space::{MAX_TIME_S, inside};
use crate::together::Together;
use serde_spanned::Spanned;
use sim::physics::{DoorSpec, Leaf, Motion, ObstacleSpec, Opening, Rectangle};

const MOST_SWITCHES: usize = 100_000;
/// The kinds of opening, and the keys of each.
const OPENINGS: [(&str, Kind); 3] =
    [("periodic", Kind::Periodic), ("random", Kind::Random), ("scripted", Kind::Scripted)];

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Periodic,
    Random,
    Scripted,
}

impl Context<'_> {
    pub(super) fn door(self, is_hinged: bool) -> Result<ObstacleSpec, WorldError> {
        let (table, file) = (self.table(), self.file);
        let end = |key: &str, value| table.point(key, self.needed(key, value)?, self.size);
        let open = match is_hinged {
            true => table.number_or("open_deg", &file.open_deg, 90.0, -180.0..=180.0).map(Some),
            false => table.number_if("slide_m", &file.slide_m, -10.0..=10.0),
        };
        let (from, to, thickness_m, open, move_s, opening) = (
            end("from_m", &file.from_m),
            end("to_m", &file.to_m),
            self.needed("thickness_m", &file.thickness_m)
                .and_then(|thickness| table.number("thickness_m", thickness, 0.01..=1.0)),
            open,
            table.number_or("move_s", &file.move_s, 1.0, 0.05..=3600.0),
            self.opening(),
        )
            .together()?;
        let length_m = (to - from).norm();
        if !(0.1..=10.0).contains(&length_m) {
            let [from, to] =
                [&file.from_m, &file.to_m].map(|end| end.as_ref().map_or(self.span(), Spanned::span));
            let what = format!("the leaf of `{}` is {length_m:.3} m long", self.name);
            let help = "it must be 0.1 to 10 m long";
            return Err(self.source.error(&what, (to, "to here"), &[(from, "from here")], help));
        }
        let shape = Rectangle::along(from, to, thickness_m);
        let what = format!("the leaf of `{}` reaches out of the map", self.name);
        let is_inside = inside(self.source, &what, self.span(), &shape, self.size);
        let (leaf, way_m) = if is_hinged {
            let open_rad = open.unwrap_or_default().to_radians();
            (Leaf::Hinged { hinge: from, open_rad }, open_rad.abs() * length_m)
        } else {
            let slide_m = open.unwrap_or(length_m);
            (Leaf::Sliding { by_m: (from - to) / length_m * slide_m }, slide_m.abs())
        };
        (is_inside, self.is_swing_slow(way_m, move_s)).together()?;
        let starts_open = file.starts_open.as_ref().is_some_and(|open| *open.get_ref());
        Ok(self.spec(shape, Motion::Door(DoorSpec { leaf, opening, move_s, starts_open })))
    }

    /// In one step no point of the leaf goes farther than what the physics keeps apart.
    fn is_swing_slow(&self, way_m: f64, move_s: f64) -> Result<(), WorldError> {
        if way_m / move_s <= self.fastest_mps() {
            return Ok(());
        }
        let what = format!("the leaf of `{}` moves at {:.3} m/s", self.name, way_m / move_s);
        let help = format!("`move_s` must be {:.3} or more", way_m / self.fastest_mps());
        let mark = self.file.move_s.as_ref().map_or(self.span(), Number::span);
        Err(self.source.error(&what, (mark, "too fast"), &[], &help))
    }

    fn opening(&self) -> Result<Opening, WorldError> {
        let (table, file) = (self.table(), self.file);
        let Some(kind) = &file.opening else {
            let help = "it needs an `opening`: \"periodic\", \"random\" or \"scripted\"";
            return Err(self.incomplete("door", help));
        };
        let word = table.choice("opening", &file.opening, &OPENINGS)?;
        let is_scripted = word == Kind::Scripted;
        match (&file.closed_s, &file.open_s, &file.switches_s) {
            (Some(closed), Some(open), None) if !is_scripted => {
                let (closed_s, open_s) = (
                    table.number("closed_s", closed, 0.1..=MAX_TIME_S),
                    table.number("open_s", open, 0.1..=MAX_TIME_S),
                )
                    .together()?;
                Ok(match word {
                    Kind::Random => Opening::Random { closed_s, open_s },
                    _ => Opening::Periodic { closed_s, open_s },
                })
            }
            (None, None, Some(switches)) if is_scripted => {
                if switches.get_ref().len() > MOST_SWITCHES {
                    let what = format!("the door `{}` switches too often", self.name);
                    let help = format!("{MOST_SWITCHES} times are the most");
                    return Err(self.source.error(&what, (switches.span(), "these times"), &[], &help));
                }
                let switches_s = table.numbers("switches_s", switches.get_ref(), 0.0..=MAX_TIME_S)?;
                if let Some(early) = switches_s.windows(2).position(|pair| pair[1] <= pair[0]) {
                    let help = "each time must be later than the one before";
                    let what = "`obstacle.switches_s` is not in order";
                    let time = &switches.get_ref()[early + 1];
                    return Err(self.source.error(what, (time.span(), "too early"), &[], help));
                }
                Ok(Opening::Scripted { switches_s })
            }
            _ => {
                let what = format!("the opening of `{}` does not fit its times", self.name);
                let help = match is_scripted {
                    true => "a scripted door has `switches_s`: the times at which it opens, closes, opens, …",
                    false => {
                        "such a door has `closed_s` and `open_s`: how long it stays so, or the means of that"
                    }
                };
                Err(self.source.error(&what, (kind.span(), "this opening"), &[], help))
            }
        }
    }
}

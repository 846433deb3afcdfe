//! `things.json`: the doors that were found, and the furniture that was moved.

use crate::numbers::rounded;
use files::{OutputError, write_file};
use mapper::{Door, Leaf, Mapper, ThingKind};
use nalgebra::Point2;
use serde::Serialize;
use std::path::Path;

/// The probability with which the interval contains the number of openings per hour.
const MASS: f64 = 0.9;

/// A thing, as the file has it. Lengths in m, times in s by the clock of the map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThingRecord {
    /// Its number, which it keeps in later sessions.
    pub id: u32,
    /// The time at which it was found, s.
    pub found_s: f64,
    /// What it is.
    #[serde(flatten)]
    pub kind: KindRecord,
}

/// What a thing is.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum KindRecord {
    /// A door.
    Door {
        /// The ends of the closed leaf, m.
        closed_m: [[f64; 2]; 2],
        /// The hinge, m, and the end of the open leaf, m; `null` if the open leaf was never seen.
        hinge_m: Option<[f64; 2]>,
        /// The end of the open leaf that is not the hinge, m.
        open_end_m: Option<[f64; 2]>,
        /// Whether it was open when it was last seen.
        is_open: Option<bool>,
        /// The time of the last look, s.
        last_seen_s: f64,
        /// Openings and closings in view.
        opened: u32,
        /// Closings in view.
        closed: u32,
        /// Openings and closings that were found after a gap in the view.
        moved_after_gap: u32,
        /// The time in view, s.
        in_view_s: f64,
        /// Openings per hour; `null` if it was never in view.
        openings_per_hour: Option<f64>,
        /// The ends of the 90 % credible interval of this number.
        openings_per_hour_90: Option<(f64, f64)>,
    },
    /// A piece of furniture that was moved.
    Furniture {
        /// Where it stood, m; `null` if that was not seen.
        from_m: Option<[f64; 2]>,
        /// Where it stands, m; `null` if that was not seen.
        to_m: Option<[f64; 2]>,
        /// It was moved between these times, s.
        moved_between_s: Option<[f64; 2]>,
    },
}

/// To a millimeter.
fn pair(point: &Point2<f64>) -> [f64; 2] {
    [point.x, point.y].map(|length_m| libm::round(1e3 * length_m) / 1e3)
}

/// All things of a map, in the order in which they were found.
pub fn records(mapper: &Mapper) -> Vec<ThingRecord> {
    let record = |thing: &mapper::Thing| {
        let kind = match &thing.kind {
            ThingKind::Door(door) => of_door(door),
            ThingKind::Furniture(furniture) => KindRecord::Furniture {
                from_m: furniture.from.as_ref().map(|place| pair(&place.center)),
                to_m: furniture.to.as_ref().map(|place| pair(&place.center)),
                moved_between_s: furniture.places().next().map(|place| place.between_s.map(rounded)),
            },
        };
        ThingRecord { id: thing.id, found_s: rounded(thing.found_s), kind }
    };
    mapper.things().iter().map(record).collect()
}

fn of_door(door: &Door) -> KindRecord {
    let seen = &door.statistics;
    let hinged = match door.leaf {
        Leaf::Hinged { hinge, length_m, open_rad, .. } => {
            let end = hinge + interfaces::rotation(open_rad) * nalgebra::Vector2::x() * length_m;
            Some((pair(&hinge), pair(&end)))
        }
        Leaf::Sliding => None,
    };
    KindRecord::Door {
        closed_m: door.closed.ends.each_ref().map(pair),
        hinge_m: hinged.map(|(hinge, _)| hinge),
        open_end_m: hinged.map(|(_, end)| end),
        is_open: door.is_open,
        last_seen_s: rounded(door.last_seen_s),
        opened: seen.opened,
        closed: seen.closed,
        moved_after_gap: seen.opened_after_gap + seen.closed_after_gap,
        in_view_s: rounded(seen.in_view_s),
        openings_per_hour: seen.openings_per_hour().map(|rate| rounded(rate.mean())),
        openings_per_hour_90: seen
            .interval_of_openings_per_hour(MASS)
            .map(|(low, high)| (rounded(low), rounded(high))),
    }
}

/// Writes the file.
///
/// # Errors
///
/// When the file cannot be written.
pub fn write(path: &Path, mapper: &Mapper) -> Result<(), OutputError> {
    write_file(path, |file| {
        serde_json::to_writer_pretty(&mut *file, &records(mapper))?;
        writeln!(file)
    })
}

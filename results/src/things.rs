//! `things.json`: the doors that were found, and the furniture that was moved.

use crate::numbers::rounded;
use files::{OutputError, write_file};
use mapper::{Door, Leaf, Mapper, Thing, ThingKind};
use nalgebra::Point2;
use serde_json::{Value, json};
use std::path::Path;

/// The probability with which the interval contains the number of openings per hour.
const MASS: f64 = 0.9;

/// To a millimeter.
fn pair(point: &Point2<f64>) -> [f64; 2] {
    [point.x, point.y].map(|length_m| libm::round(1e3 * length_m) / 1e3)
}

/// A thing, as the file has it: lengths in m, times in s by the clock of the map, `null` where something was not seen. It keeps its
/// number in later sessions.
fn record(thing: &Thing) -> Value {
    let mut record = match &thing.kind {
        ThingKind::Door(door) => of_door(door),
        // It stood at `from_m`, stands at `to_m`, and was moved between two times.
        ThingKind::Furniture(furniture) => json!({
            "kind": "furniture",
            "from_m": furniture.from.as_ref().map(|place| pair(&place.center)),
            "to_m": furniture.to.as_ref().map(|place| pair(&place.center)),
            "moved_between_s": furniture.places().next().map(|place| place.between_s.map(rounded)),
        }),
    };
    (record["id"], record["found_s"]) = (thing.id.into(), rounded(thing.found_s).into());
    record
}

/// A door: the ends of the closed leaf, the hinge and the other end of the open leaf, its state at the last look, and what was counted:
/// in view, and what was found after a gap in the view; the openings per hour with their 90 % credible interval.
fn of_door(door: &Door) -> Value {
    let hinged = match door.leaf {
        Leaf::Hinged { hinge, length_m, open_rad, .. } => {
            let end = hinge + interfaces::rotation(open_rad) * nalgebra::Vector2::x() * length_m;
            Some((pair(&hinge), pair(&end)))
        }
        Leaf::Sliding => None,
    };
    let (low, high) = door.interval_of_openings_per_hour(MASS);
    let [opened, closed] = door.moves();
    json!({
        "kind": "door",
        "closed_m": door.closed.ends.each_ref().map(pair),
        "hinge_m": hinged.map(|(hinge, _)| hinge),
        "open_end_m": hinged.map(|(_, end)| end),
        "is_open": door.is_open(),
        "last_seen_s": rounded(door.last_seen_s()),
        "opened": opened,
        "closed": closed,
        "moved_after_gap": door.moves_after_gap(),
        "in_view_s": rounded(door.in_view_s()),
        "openings_per_hour": rounded(door.openings_per_hour()),
        "openings_per_hour_90": [rounded(low), rounded(high)],
    })
}

/// Writes the file: all things of a map, in the order in which they were found.
///
/// # Errors
///
/// When the file cannot be written.
pub fn write(path: &Path, mapper: &Mapper) -> Result<(), OutputError> {
    let records: Vec<Value> = mapper.things().iter().map(record).collect();
    write_file(path, |file| {
        serde_json::to_writer_pretty(&mut *file, &records)?;
        writeln!(file)
    })
}

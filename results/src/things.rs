//! `things.json`: the doors that were found, and the objects that come and go.

use crate::numbers::rounded;
use files::{OutputError, write_file};
use interfaces::GridFrame;
use mapper::{Door, Leaf, Mapper, ObjectReport};
use nalgebra::{Point2, Vector2};
use serde_json::{Value, json};
use std::path::Path;

/// To a millimeter.
fn pair(point: &Point2<f64>) -> [f64; 2] {
    [point.x, point.y].map(|length_m| libm::round(1e3 * length_m) / 1e3)
}

/// An object: the middle of its cells and their number, its state at the last look, and what was counted: in view, and what was found
/// after a gap in the view; the cycles per hour with their 90 % credible interval.
fn of_object(object: &ObjectReport, frame: &GridFrame) -> Value {
    let centers = object.cells.iter().map(|cell| frame.center(frame.cell(*cell as usize)).coords);
    json!({
        "id": object.id,
        "found_s": rounded(object.found_s),
        "kind": "object",
        "at_m": pair(&(centers.sum::<Vector2<f64>>() / object.cells.len() as f64).into()),
        "cells": object.cells.len(),
        "is_there": object.is_there,
        "last_seen_s": rounded(object.last_seen_s),
        "moved": object.evidence.events().iter().sum::<u32>(),
        "moved_after_gap": object.evidence.changes_after_gap(),
        "cycles_per_hour": rounded(object.cycles_per_hour),
        "cycles_per_hour_90": object.cycles_per_hour_90.map(rounded),
    })
}

/// A door: the ends of the closed leaf, the hinge and the other end of the open leaf, its state at the last look, and what was counted:
/// in view, and what was found after a gap in the view; the openings per hour with their 90 % credible interval.
fn of_door(door: &Door) -> Value {
    let hinged = match door.leaf {
        Leaf::Hinged { hinge, length_m, open_rad, .. } => {
            let end = hinge + interfaces::rotation(open_rad) * Vector2::x() * length_m;
            Some((pair(&hinge), pair(&end)))
        }
        Leaf::Sliding => None,
    };
    let (per_hour, ends) = door.openings_per_hour();
    let evidence = door.evidence();
    let [closed, opened] = evidence.events();
    json!({
        "id": door.id,
        "found_s": rounded(door.found_s),
        "kind": "door",
        "closed_m": door.closed.ends.each_ref().map(pair),
        "hinge_m": hinged.map(|(hinge, _)| hinge),
        "open_end_m": hinged.map(|(_, end)| end),
        "is_open": door.is_open(),
        "last_seen_s": rounded(door.last_seen_s()),
        "opened": opened,
        "closed": closed,
        "moved_after_gap": evidence.changes_after_gap(),
        "in_view_s": rounded(evidence.in_view_s()),
        "openings_per_hour": rounded(per_hour),
        "openings_per_hour_90": ends.map(rounded),
    })
}

/// Writes the file: all doors and objects of a map. They keep their numbers in later sessions. Lengths are in m, times in s by the clock of
/// the map, `null` where something was not seen.
///
/// # Errors
///
/// When the file cannot be written.
pub fn write(path: &Path, mapper: &Mapper) -> Result<(), OutputError> {
    let objects = mapper.objects().map(|object| of_object(&object, mapper.frame()));
    let records: Vec<Value> = mapper.doors().iter().map(of_door).chain(objects).collect();
    write_file(path, |file| {
        serde_json::to_writer_pretty(&mut *file, &records)?;
        writeln!(file)
    })
}

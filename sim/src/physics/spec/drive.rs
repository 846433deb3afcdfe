//! The drive of a robot.

use super::file::{DriveFile, Number};
use super::numbers::Table;
use super::{DriveKind, DriveLimits};
use crate::error::{Source, WorldError};
use std::ops::RangeInclusive;

const KINDS: [(&str, Kind); 3] = [("diff", Kind::Diff), ("omni", Kind::Omni), ("car", Kind::Car)];

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Diff,
    Omni,
    Car,
}

/// Checks a drive. No robot goes farther in a step than its radius: so fast is `radius_per_step_mps`.
pub(super) fn drive(
    source: &Source<'_>,
    file: &DriveFile,
    radius_per_step_mps: f64,
) -> Result<DriveLimits, WorldError> {
    let table = Table { source, path: "robot.drive" };
    // Slower than a radius per step, so that no body can pass through another between two steps.
    let fastest_mps = radius_per_step_mps.min(5.0);
    let turn_degps = table.number("max_angular_degps", &file.max_angular_degps, 0.1..=3600.0)?;
    let (gain, spin) = (&file.max_linear_acceleration_mps2, &file.max_angular_acceleration_degps2);
    let mut limits = DriveLimits {
        kind: DriveKind::Differential,
        max_linear_mps: table.number("max_linear_mps", &file.max_linear_mps, 0.001..=fastest_mps)?,
        max_angular_radps: turn_degps.to_radians(),
        max_linear_acceleration_mps2: table.number("max_linear_acceleration_mps2", gain, 0.001..=100.0)?,
        max_angular_acceleration_radps2: table
            .number("max_angular_acceleration_degps2", spin, 0.1..=100_000.0)?
            .to_radians(),
    };
    let kind = table.choice("kind", &file.kind, &KINDS)?;
    let keys: [(&str, &Option<Number>, Kind); 4] = [
        ("max_left_mps", &file.max_left_mps, Kind::Omni),
        ("max_left_acceleration_mps2", &file.max_left_acceleration_mps2, Kind::Omni),
        ("wheelbase_m", &file.wheelbase_m, Kind::Car),
        ("max_steer_deg", &file.max_steer_deg, Kind::Car),
    ];
    for (key, value, of) in keys {
        if let Some(value) = value.as_ref().filter(|_| of != kind) {
            let owner = if of == Kind::Car { "car" } else { "omni" };
            let what = format!("this drive has no `{key}`");
            let help = format!("leave it out: only a drive of `kind = \"{owner}\"` has one");
            return Err(source.error(&what, (value.span(), "not for this drive"), &[], &help));
        }
    }
    let or = |key: &str, value: &Option<Number>, default: f64, range: RangeInclusive<f64>| {
        table.number_or(key, value, default, range)
    };
    match kind {
        Kind::Diff => {}
        Kind::Omni => {
            let (fast, gain) = (limits.max_linear_mps, limits.max_linear_acceleration_mps2);
            let max_left_mps = or("max_left_mps", &file.max_left_mps, fast, 0.001..=fastest_mps)?;
            let left_gain = &file.max_left_acceleration_mps2;
            let max_left_acceleration_mps2 =
                or("max_left_acceleration_mps2", left_gain, gain, 0.001..=100.0)?;
            limits.kind = DriveKind::Omni { max_left_mps, max_left_acceleration_mps2 };
            // Both at once must not be too fast either.
            let both_mps = limits.fastest_mps();
            if both_mps > radius_per_step_mps {
                let what = format!("forwards and sideways at once this is {both_mps:.3} m/s");
                let help = format!("{radius_per_step_mps:.3} m/s are the most: one radius per physics step");
                let mark = file.max_left_mps.as_ref().map_or(file.max_linear_mps.span(), Number::span);
                return Err(source.error(&what, (mark, "too fast"), &[], &help));
            }
        }
        Kind::Car => {
            let Some(wheelbase) = &file.wheelbase_m else {
                let mark = file.kind.as_ref().map_or(file.max_linear_mps.span(), |kind| kind.span());
                let help = "add a line `wheelbase_m = …`: from the rear to the front axle";
                return Err(source.error("a car needs a wheelbase", (mark, "this car"), &[], help));
            };
            let wheelbase_m = table.number("wheelbase_m", wheelbase, 0.01..=10.0)?;
            let max_steer_rad = or("max_steer_deg", &file.max_steer_deg, 30.0, 1.0..=80.0)?.to_radians();
            limits.kind = DriveKind::Car { wheelbase_m, max_steer_rad };
        }
    }
    Ok(limits)
}

//! The drive of a robot.

use super::file::{DriveFile, Number};
use super::numbers::Table;
use crate::error::{Source, WorldError};
use crate::together::Together;
use sim::physics::{DriveKind, DriveLimits};
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
    let kind = table.choice("kind", &file.kind, &KINDS);
    let of = |owner: Kind, key: &str, value: &Option<Number>, range: RangeInclusive<f64>| match value {
        Some(value) if kind.as_ref().is_ok_and(|kind| *kind != owner) => {
            let owner = if owner == Kind::Car { "car" } else { "omni" };
            let what = format!("this drive has no `{key}`");
            let help = format!("leave it out: only a drive of `kind = \"{owner}\"` has one");
            Err(source.error(&what, (value.span(), "not for this drive"), &[], &help))
        }
        value => table.number_if(key, value, range),
    };
    let wheelbase_m = match &file.wheelbase_m {
        None if kind == Ok(Kind::Car) => {
            let mark = file.kind.as_ref().map_or(file.max_linear_mps.span(), |kind| kind.span());
            let help = "add a line `wheelbase_m = …`: from the rear to the front axle";
            Err(source.error("a car needs a wheelbase", (mark, "this car"), &[], help))
        }
        value => of(Kind::Car, "wheelbase_m", value, 0.01..=10.0),
    };
    let all = (
        table.number("max_linear_mps", &file.max_linear_mps, 0.001..=fastest_mps),
        table.number("max_angular_degps", &file.max_angular_degps, 0.1..=3600.0),
        table.number("max_linear_acceleration_mps2", &file.max_linear_acceleration_mps2, 0.001..=100.0),
        table.number(
            "max_angular_acceleration_degps2",
            &file.max_angular_acceleration_degps2,
            0.1..=100_000.0,
        ),
    );
    let own = (
        of(Kind::Omni, "max_left_mps", &file.max_left_mps, 0.001..=fastest_mps),
        of(Kind::Omni, "max_left_acceleration_mps2", &file.max_left_acceleration_mps2, 0.001..=100.0),
        wheelbase_m,
        of(Kind::Car, "max_steer_deg", &file.max_steer_deg, 1.0..=80.0),
    );
    let (all, own, kind) = (all.together(), own.together(), kind).together()?;
    let (fast_mps, turn_degps, gain_mps2, spin_degps2) = all;
    let (left_mps, left_gain_mps2, wheelbase_m, steer_deg) = own;
    let kind = match (kind, wheelbase_m) {
        (Kind::Car, Some(wheelbase_m)) => {
            DriveKind::Car { wheelbase_m, max_steer_rad: steer_deg.unwrap_or(30.0).to_radians() }
        }
        (Kind::Omni, _) => DriveKind::Omni {
            max_left_mps: left_mps.unwrap_or(fast_mps),
            max_left_acceleration_mps2: left_gain_mps2.unwrap_or(gain_mps2),
        },
        _ => DriveKind::Differential,
    };
    let limits = DriveLimits {
        kind,
        max_linear_mps: fast_mps,
        max_angular_radps: turn_degps.to_radians(),
        max_linear_acceleration_mps2: gain_mps2,
        max_angular_acceleration_radps2: spin_degps2.to_radians(),
    };
    // Forwards and sideways at once must not be too fast either.
    let both_mps = limits.fastest_mps();
    if both_mps > radius_per_step_mps {
        let what = format!("forwards and sideways at once this is {both_mps:.3} m/s");
        let help = format!("{radius_per_step_mps:.3} m/s are the most: one radius per physics step");
        let mark = file.max_left_mps.as_ref().map_or(file.max_linear_mps.span(), Number::span);
        return Err(source.error(&what, (mark, "too fast"), &[], &help));
    }
    Ok(limits)
}

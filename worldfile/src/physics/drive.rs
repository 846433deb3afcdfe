//! The drive of a robot.

use crate::reader::Table;
use sim::physics::{DriveKind, DriveLimits};
use std::ops::RangeInclusive;

pub(super) const KEYS: &str = "kind, max_linear_mps, max_angular_degps, max_linear_acceleration_mps2, \
                               max_angular_acceleration_degps2, max_left_mps, max_left_acceleration_mps2, \
                               wheelbase_m, max_steer_deg";

const KINDS: [(&str, &str); 3] = [("diff", "diff"), ("omni", "omni"), ("car", "car")];

/// The limits of a drive. No robot moves by more than its radius in a step: `radius_per_step_mps` is that speed.
pub(super) fn drive(table: &Table<'_>, radius_per_step_mps: f64) -> Option<DriveLimits> {
    // Less than a radius per step, so that no body can pass through another between two steps.
    let fastest_mps = radius_per_step_mps.min(5.0);
    let kind = table.choice("kind", &KINDS);
    let max_linear_mps = table.number("max_linear_mps", 0.001..=fastest_mps);
    let max_linear_acceleration_mps2 = table.number("max_linear_acceleration_mps2", 0.001..=100.0);
    let of = |owner: &str, key: &'static str, range: RangeInclusive<f64>| {
        if table.has(key) && kind.is_some_and(|kind| kind != owner) {
            let what = format!("this drive has no `{key}`");
            let help = format!("leave it out: only a drive of `kind = \"{owner}\"` has one");
            let foreign = table.error(&what, (table.at(key), "not for this drive"), &[], &help);
            return Some(table.or_invalid(foreign, f64::NAN));
        }
        table.number_if(key, range)
    };
    let max_left_mps = of("omni", "max_left_mps", 0.001..=fastest_mps);
    let max_left_acceleration_mps2 = of("omni", "max_left_acceleration_mps2", 0.001..=100.0);
    let wheelbase_m = of("car", "wheelbase_m", 0.01..=10.0);
    let max_steer_deg = of("car", "max_steer_deg", 1.0..=80.0);
    if kind == Some("car") && !table.has("wheelbase_m") {
        let help = "add a line `wheelbase_m = …`: from the rear to the front axle";
        table.error::<()>("a car needs a wheelbase", (table.at("kind"), "this car"), &[], help);
    }
    let limits = DriveLimits {
        max_linear_mps,
        max_angular_radps: table.number("max_angular_degps", 0.1..=3600.0).to_radians(),
        max_linear_acceleration_mps2,
        max_angular_acceleration_radps2: table
            .number("max_angular_acceleration_degps2", 0.1..=100_000.0)
            .to_radians(),
        kind: match kind? {
            "car" => DriveKind::Car {
                wheelbase_m: wheelbase_m?,
                max_steer_rad: max_steer_deg.unwrap_or(30.0).to_radians(),
            },
            "omni" => DriveKind::Omni {
                max_left_mps: max_left_mps.unwrap_or(max_linear_mps),
                max_left_acceleration_mps2: max_left_acceleration_mps2
                    .unwrap_or(max_linear_acceleration_mps2),
            },
            _ => DriveKind::Differential,
        },
    };
    // Forwards and sideways at once must not be too fast either.
    let both_mps = limits.fastest_mps();
    if both_mps > radius_per_step_mps {
        let what = format!("forwards and sideways at once this is {both_mps:.3} m/s");
        let help = format!("{radius_per_step_mps:.3} m/s are the most: one radius per physics step");
        let key = if table.has("max_left_mps") { "max_left_mps" } else { "max_linear_mps" };
        return table.error(&what, (table.at(key), "too fast"), &[], &help);
    }
    table.sound(limits)
}

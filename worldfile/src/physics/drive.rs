//! The drive of a robot.

use super::kind::{KindOf, kind_of};
use crate::reader::Table;
use sim::physics::{DriveKind, DriveLimits};

pub(super) const KEYS: &str = "kind, max_linear_mps, max_angular_degps, max_linear_acceleration_mps2, \
                               max_angular_acceleration_degps2, lateral_grip, max_left_mps, \
                               max_left_acceleration_mps2, wheelbase_m, max_steer_deg";

const KINDS: [KindOf; 3] = [
    ("diff", "lateral_grip", "drives straight ahead and turns"),
    ("omni", "max_left_mps, max_left_acceleration_mps2", "drives in all directions"),
    ("car", "lateral_grip, wheelbase_m, max_steer_deg", "steers with its front wheels"),
];

/// The limits of a drive. No robot moves by more than its radius in a step: `radius_per_step_mps` is that speed.
pub(super) fn drive(table: &Table<'_>, radius_per_step_mps: f64) -> Option<DriveLimits> {
    // Less than a radius per step, so that no body can pass through another between two steps.
    let fastest_mps = radius_per_step_mps.min(5.0);
    let max_linear_mps = table.number("max_linear_mps", 0.001..=fastest_mps);
    let max_linear_acceleration_mps2 = table.number("max_linear_acceleration_mps2", 0.001..=100.0);
    let limits = DriveLimits {
        max_linear_mps,
        max_angular_radps: table.number("max_angular_degps", 0.1..=3600.0).to_radians(),
        max_linear_acceleration_mps2,
        max_angular_acceleration_radps2: table
            .number("max_angular_acceleration_degps2", 0.1..=100_000.0)
            .to_radians(),
        lateral_grip: table.number_or("lateral_grip", DriveLimits::LATERAL_GRIP, 0.0..=10.0),
        kind: match kind_of(table, &KINDS, "a drive")? {
            "car" => DriveKind::Car {
                wheelbase_m: table.number("wheelbase_m", 0.01..=10.0),
                max_steer_rad: table.number_or("max_steer_deg", 30.0, 1.0..=80.0).to_radians(),
            },
            "omni" => DriveKind::Omni {
                max_left_mps: table.number_or("max_left_mps", max_linear_mps, 0.001..=fastest_mps),
                max_left_acceleration_mps2: table.number_or(
                    "max_left_acceleration_mps2",
                    max_linear_acceleration_mps2,
                    0.001..=100.0,
                ),
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

//! The odometry of a robot.

use crate::reader::Table;
use sim::physics::{DisplacementSpec, OdometryError};

const KEYS: &str =
    "distance_gain, turn_gain, turn_per_m_deg, distance_noise_m, turn_noise_deg, slip, jump, carried";
const DISPLACEMENT_KEYS: &str = "every_s, distance_m, turn_deg";

pub(super) fn odometry(robot: &Table<'_>) -> Option<OdometryError> {
    let table = robot.table_or_empty("odometry", KEYS)?;
    let distance_gain = table.number_or("distance_gain", 0.0, -0.5..=0.5);
    let turn_gain = table.number_or("turn_gain", 0.0, -0.5..=0.5);
    let turn_per_m_deg = table.number_or("turn_per_m_deg", 0.0, -90.0..=90.0);
    let distance_noise_m = table.number_or("distance_noise_m", 0.0, 0.0..=1.0);
    let turn_noise_deg = table.number_or("turn_noise_deg", 0.0, 0.0..=90.0);
    let slip = table.number_or("slip", 0.0, 0.0..=1.0);
    let [jump, carried] = ["jump", "carried"].map(|key| displacement(&table, key));
    table.sound(OdometryError {
        distance_gain: distance_gain?,
        turn_gain: turn_gain?,
        turn_radpm: turn_per_m_deg?.to_radians(),
        distance_noise_m: distance_noise_m?,
        turn_noise_rad: turn_noise_deg?.to_radians(),
        slip: slip?,
        jump: jump?,
        carried: carried?,
    })
}

/// `Some(None)`: the key is not given.
fn displacement(odometry: &Table<'_>, key: &'static str) -> Option<Option<DisplacementSpec>> {
    let Some(value) = odometry.get(key) else { return Some(None) };
    let table = value.table(DISPLACEMENT_KEYS)?;
    let every_s = table.number("every_s", 0.1..=1e9);
    let distance_m = table.number_or("distance_m", 0.0, 0.0..=1000.0);
    let turn_deg = table.number_or("turn_deg", 0.0, 0.0..=180.0);
    let (every_s, distance_m, turn_deg) = (every_s?, distance_m?, turn_deg?);
    if distance_m == 0.0 && turn_deg == 0.0 {
        let what = format!("`{}` displaces by nothing", odometry.path(key));
        let help = "give `distance_m` or `turn_deg` a value above 0, or leave the table out";
        return table.error(&what, (table.span.clone(), "no displacement"), &[], help);
    }
    table.sound(Some(DisplacementSpec { every_s, distance_m, turn_rad: turn_deg.to_radians() }))
}

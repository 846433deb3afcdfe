//! What all sensors of a robot have: a rate, a place, and perhaps a range.

use super::file::{Number, Pair};
use super::numbers::Table;
use crate::error::WorldError;
use crate::together::Together;
use interfaces::pose;
use nalgebra::{Isometry2, Point2};

/// Sensors stick out of the circle about their robot by this at most, m.
pub const MOST_OUT_M: f64 = 1.0;

/// A rate (Hz), and the physics steps from one measurement to the next.
pub(super) fn period_steps(table: &Table<'_>, rate: &Number, step_s: f64) -> Result<(f64, u64), WorldError> {
    let rate_hz = table.number("rate_hz", rate, 0.01..=1000.0)?;
    let steps = 1.0 / (rate_hz * step_s);
    if steps.round() >= 1.0 && (steps - steps.round()).abs() <= 1e-6 * steps {
        return Ok((rate_hz, steps.round() as u64));
    }
    let path = table.path;
    let what = format!("`{path}.rate_hz` is {rate_hz}, a scan every {steps:.3} physics steps of {step_s} s");
    let whole = steps.floor().max(1.0);
    let near = [whole, whole + 1.0].map(|steps| format!("{:.6}", 1.0 / (steps * step_s)));
    let near = near.map(|hz| hz.trim_end_matches('0').trim_end_matches('.').to_owned());
    let help = format!("scans must be whole steps apart: {} or {} Hz would be", near[0], near[1]);
    Err(table.source.error(&what, (rate.span(), "not whole steps apart"), &[], &help))
}

/// Where `what` sits on a robot that lies within `radius_m`, or how it sticks out of that.
pub(super) fn mount(
    table: &Table<'_>,
    what: &str,
    mount_m: &Option<Pair>,
    mount_deg: &Option<Number>,
    radius_m: f64,
) -> Result<Isometry2<f64>, WorldError> {
    let (at, mount_deg) = (
        mount_m.as_ref().map_or(Ok(Point2::origin()), |m| table.pair("mount_m", m, -10.0..=10.0)),
        table.number_or("mount_deg", mount_deg, 0.0, -360.0..=360.0),
    )
        .together()?;
    if let Some(file) = mount_m.as_ref().filter(|_| at.coords.norm() > radius_m + MOST_OUT_M) {
        let what = format!("{what} is mounted off its robot");
        let help = format!(
            "it must lie within the robot's radius of {radius_m} m, or stick out by {MOST_OUT_M} m at most"
        );
        return Err(table.source.error(&what, (file.span(), "off the robot"), &[], &help));
    }
    Ok(pose(at.x, at.y, mount_deg.to_radians()))
}

/// The least and the greatest range, m.
pub(super) fn range(
    table: &Table<'_>,
    least: &Option<Number>,
    most: &Number,
) -> Result<[f64; 2], WorldError> {
    let (range_max_m, range_min_m) = (
        table.number("range_max_m", most, 0.01..=1000.0),
        table.number_or("range_min_m", least, 0.0, 0.0..=1000.0),
    )
        .together()?;
    if let Some(min) = least.as_ref().filter(|_| range_min_m >= range_max_m) {
        let marks = [(most.span(), "not below this")];
        let help = "`range_min_m` must be smaller than `range_max_m`";
        let what = if table.path == "robot.laser" { "a laser sees nothing" } else { "a sonar hears nothing" };
        return Err(table.source.error(what, (min.span(), "too far"), &marks, help));
    }
    Ok([range_min_m, range_max_m])
}

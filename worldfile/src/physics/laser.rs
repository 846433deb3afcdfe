//! The lasers of a robot.

use super::file::{LaserFile, Number, Pair, RobotFile};
use super::numbers::Table;
use super::senses::range;
use crate::error::{Source, WorldError};
use crate::together::Together;
use interfaces::pose;
use nalgebra::{Isometry2, Point2};
use sim::physics::LaserSpec;

/// More lasers on one robot than this are refused.
const MOST_LASERS: usize = 100;
/// Sensors stick out of the circle about their robot by this at most, m.
pub const MOST_OUT_M: f64 = 1.0;

/// The first laser of a robot, and the others.
pub(super) fn lasers(
    source: &Source<'_>,
    robot: &RobotFile,
    step_s: f64,
    radius_m: f64,
) -> Result<(LaserSpec, Vec<LaserSpec>), WorldError> {
    let files = &robot.lasers.get_ref().0;
    let Some((first, others)) = files.split_first().filter(|_| files.len() <= MOST_LASERS) else {
        let what = format!("the robot `{}` has {} lasers", robot.name.get_ref(), files.len());
        let help = format!("it must have 1 to {MOST_LASERS}");
        return Err(source.error(&what, (robot.lasers.span(), "these lasers"), &[], &help));
    };
    let others = others.iter().map(|file| laser(source, file, step_s, radius_m)).collect::<Vec<_>>();
    (laser(source, first, step_s, radius_m), others.together()).together()
}

fn laser(source: &Source<'_>, file: &LaserFile, step_s: f64, radius_m: f64) -> Result<LaserSpec, WorldError> {
    let table = Table { source, path: "robot.laser" };
    let (beams, fov_deg, range, rate, mount, noise_std_m, dropout) = (
        table.count("beams", &file.beams, 2..=10_000),
        table.number_or("fov_deg", &file.fov_deg, 360.0, 1.0..=360.0),
        range(&table, &file.range_min_m, &file.range_max_m),
        period_steps(&table, &file.rate_hz, step_s),
        mount(&table, "a laser", &file.mount_m, &file.mount_deg, radius_m),
        table.number_or("noise_std_m", &file.noise_std_m, 0.0, 0.0..=1.0),
        table.number_or("dropout", &file.dropout, 0.0, 0.0..=1.0),
    )
        .together()?;
    let ([range_min_m, range_max_m], (rate_hz, period_steps)) = (range, rate);
    let fov_rad = fov_deg.to_radians();
    Ok(LaserSpec {
        beams,
        fov_rad,
        range_min_m,
        range_max_m,
        rate_hz,
        period_steps,
        mount,
        noise_std_m,
        dropout,
    })
}

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

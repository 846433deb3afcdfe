//! The lasers of a robot.

use super::file::{LaserFile, RobotFile};
use super::numbers::Table;
use super::sensor::{mount, period_steps, range};
use crate::error::{Source, WorldError};
use crate::together::Together;
use sim::physics::LaserSpec;

/// More lasers on one robot than this are refused.
const MOST_LASERS: usize = 100;
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

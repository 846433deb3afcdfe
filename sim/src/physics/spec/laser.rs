//! The lasers of a robot.

use super::LaserSpec;
use super::file::{LaserFile, RobotFile};
use super::numbers::Table;
use crate::error::{Source, WorldError};
use geometry::pose;
use nalgebra::Point2;

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
    let others = others.iter().map(|file| laser(source, file, step_s, radius_m));
    Ok((laser(source, first, step_s, radius_m)?, others.collect::<Result<_, _>>()?))
}

fn laser(source: &Source<'_>, file: &LaserFile, step_s: f64, radius_m: f64) -> Result<LaserSpec, WorldError> {
    let table = Table { source, path: "robot.laser" };
    let beams = *file.beams.get_ref();
    if !(2..=10_000).contains(&beams) {
        let what = format!("`robot.laser.beams` is {beams}, which is out of range");
        let help = "it must be a whole number from 2 to 10000";
        return Err(source.error(&what, (file.beams.span(), "out of range"), &[], help));
    }
    let range_max_m = table.number("range_max_m", &file.range_max_m, 0.01..=1000.0)?;
    let range_min_m = table.number_or("range_min_m", &file.range_min_m, 0.0, 0.0..=1000.0)?;
    if let Some(min) = file.range_min_m.as_ref().filter(|_| range_min_m >= range_max_m) {
        let marks = [(file.range_max_m.span(), "not below this")];
        let help = "`range_min_m` must be smaller than `range_max_m`";
        return Err(source.error("a laser sees nothing", (min.span(), "too far"), &marks, help));
    }
    let rate_hz = table.number("rate_hz", &file.rate_hz, 0.01..=1000.0)?;
    let steps = 1.0 / (rate_hz * step_s);
    if steps.round() < 1.0 || (steps - steps.round()).abs() > 1e-6 * steps {
        let what = format!(
            "`robot.laser.rate_hz` is {rate_hz}, a scan every {steps:.3} physics steps of {step_s} s"
        );
        let whole = steps.floor().max(1.0);
        let near = [whole, whole + 1.0].map(|steps| format!("{:.6}", 1.0 / (steps * step_s)));
        let near = near.map(|hz| hz.trim_end_matches('0').trim_end_matches('.').to_owned());
        let help = format!("scans must be whole steps apart: {} or {} Hz would be", near[0], near[1]);
        return Err(source.error(&what, (file.rate_hz.span(), "not whole steps apart"), &[], &help));
    }
    let mount =
        file.mount_m.as_ref().map_or(Ok(Point2::origin()), |m| table.pair("mount_m", m, -10.0..=10.0))?;
    if let Some(file) = file.mount_m.as_ref().filter(|_| mount.coords.norm() > radius_m) {
        let help = format!("it must lie within the robot's radius of {radius_m} m");
        return Err(source.error(
            "a laser is mounted off its robot",
            (file.span(), "off the robot"),
            &[],
            &help,
        ));
    }
    let mount_deg = table.number_or("mount_deg", &file.mount_deg, 0.0, -360.0..=360.0)?;
    Ok(LaserSpec {
        dropout: table.number_or("dropout", &file.dropout, 0.0, 0.0..=1.0)?,
        beams: beams as usize,
        fov_rad: table.number_or("fov_deg", &file.fov_deg, 360.0, 1.0..=360.0)?.to_radians(),
        range_min_m,
        range_max_m,
        rate_hz,
        period_steps: steps.round() as u64,
        mount: pose(mount.x, mount.y, mount_deg.to_radians()),
        noise_std_m: table.number_or("noise_std_m", &file.noise_std_m, 0.0, 0.0..=1.0)?,
    })
}

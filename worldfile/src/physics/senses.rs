//! Sensors other than lasers: bumpers, sonars, fiducial finders.

use super::file::{BumperFile, FiducialFile, Number, Pair, SonarFile};
use super::numbers::Table;
use super::sensor::{mount, period_steps, range};
use crate::error::{Source, WorldError};
use crate::together::Together;
use nalgebra::Isometry2;
use serde_spanned::Spanned;
use sim::physics::{BumperSpec, FiducialSpec, SonarSpec};

/// More sonars on one robot than this are refused.
const MOST_SONARS: usize = 100;

pub(super) fn bumper(source: &Source<'_>, file: &BumperFile) -> Result<BumperSpec, WorldError> {
    let table = Table { source, path: "robot.bumper" };
    let sectors = table.count("sectors", &file.sectors, 1..=64);
    let fov_deg = table.number_or("fov_deg", &file.fov_deg, 360.0, 1.0..=360.0);
    let (sectors, fov_deg) = (sectors, fov_deg).together()?;
    Ok(BumperSpec { sectors, fov_rad: fov_deg.to_radians() })
}

pub(super) fn sonars(
    source: &Source<'_>,
    files: &[Spanned<SonarFile>],
    step_s: f64,
    radius_m: f64,
) -> Result<Vec<SonarSpec>, WorldError> {
    if let Some(last) = files.get(MOST_SONARS) {
        let help = format!("{MOST_SONARS} are the most");
        return Err(source.error("a robot has too many sonars", (last.span(), "one too many"), &[], &help));
    }
    let sonars = files.iter().map(|file| sonar(source, file.get_ref(), step_s, radius_m));
    sonars.collect::<Vec<_>>().together()
}

fn sonar(source: &Source<'_>, file: &SonarFile, step_s: f64, radius_m: f64) -> Result<SonarSpec, WorldError> {
    let table = Table { source, path: "robot.sonar" };
    let (cone_deg, [range_min_m, range_max_m], (_, period_steps), mount, noise_std_m) = (
        table.number("cone_deg", &file.cone_deg, 1.0..=180.0),
        range(&table, &file.range_min_m, &file.range_max_m),
        period_steps(&table, &file.rate_hz, step_s),
        place(&table, &file.mount_m, &file.mount_deg, radius_m),
        table.number_or("noise_std_m", &file.noise_std_m, 0.0, 0.0..=1.0),
    )
        .together()?;
    let cone_rad = cone_deg.to_radians();
    Ok(SonarSpec { cone_rad, range_min_m, range_max_m, period_steps, mount, noise_std_m })
}

pub(super) fn fiducial(
    source: &Source<'_>,
    file: &FiducialFile,
    step_s: f64,
    radius_m: f64,
) -> Result<FiducialSpec, WorldError> {
    let table = Table { source, path: "robot.fiducial" };
    let (fov_deg, range_max_m, (_, period_steps), mount) = (
        table.number_or("fov_deg", &file.fov_deg, 360.0, 1.0..=360.0),
        table.number("range_max_m", &file.range_max_m, 0.01..=1000.0),
        period_steps(&table, &file.rate_hz, step_s),
        place(&table, &file.mount_m, &file.mount_deg, radius_m),
    )
        .together()?;
    Ok(FiducialSpec { fov_rad: fov_deg.to_radians(), range_max_m, period_steps, mount })
}

fn place(
    table: &Table<'_>,
    mount_m: &Option<Pair>,
    mount_deg: &Option<Number>,
    radius_m: f64,
) -> Result<Isometry2<f64>, WorldError> {
    mount(table, "a sensor", mount_m, mount_deg, radius_m)
}

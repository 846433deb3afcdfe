//! A robot: its body, drive, odometry and laser.

use super::behaviour::Context;
use super::check::Solid;
use super::file::{LaserFile, OdometryFile, RobotFile};
use super::numbers::Table;
use super::{DriveLimits, LaserSpec, OdometryError, RobotSpec};
use crate::error::{Source, WorldError};
use crate::physics::shape::TOUCH_M;
use geometry::pose;
use nalgebra::Point2;

pub(super) fn robot(
    source: &Source<'_>,
    file: &RobotFile,
    size: &Point2<f64>,
    step_s: f64,
    solids: &[Solid],
    movers: &[Solid],
) -> Result<RobotSpec, WorldError> {
    let table = Table { source, path: "robot" };
    let name = source.name("robot", &file.name)?;
    let radius_m = table.number("radius_m", &file.radius_m, 0.02..=10.0)?;
    let mass_kg =
        file.mass_kg.as_ref().map(|mass| table.number("mass_kg", mass, 0.001..=100_000.0)).transpose()?;
    let at = table.point("pose_m", &file.pose_m, size)?;
    let heading_deg = table.number_or("heading_deg", &file.heading_deg, 0.0, -360.0..=360.0)?;
    let help = format!("its middle must keep its radius of {radius_m} m away");
    if at.coords.min().min((size - at).min()) < radius_m - TOUCH_M {
        let what = format!("the robot `{name}` reaches out of the map");
        return Err(source.error(&what, (file.pose_m.span(), "too near to the border"), &[], &help));
    }
    if let Some(solid) =
        solids.iter().chain(movers).find(|solid| solid.shape.distance_m(&at) < radius_m - TOUCH_M)
    {
        let what = format!("the robot `{name}` starts in a wall or an obstacle");
        let marks = [(solid.span.clone(), "in this one")];
        return Err(source.error(&what, (file.pose_m.span(), "stands here"), &marks, &help));
    }
    let drive = drive(source, file, radius_m / step_s)?;
    let laser = laser(source, &file.laser, step_s, radius_m)?;
    let behaviour = Context { source, robot: file, start: at, drive: &drive, size, solids }.behaviour()?;
    let pose = pose(at.x, at.y, heading_deg.to_radians());
    let odometry = odometry(source, &file.odometry)?;
    Ok(RobotSpec { name, radius_m, mass_kg, pose, drive, odometry, laser, behaviour })
}

fn drive(source: &Source<'_>, file: &RobotFile, radius_per_step_mps: f64) -> Result<DriveLimits, WorldError> {
    let table = Table { source, path: "robot.drive" };
    let drive = &file.drive;
    // Slower than a radius per step, so that no body can pass through another between two steps.
    let fastest_mps = radius_per_step_mps.min(5.0);
    let turn_degps = table.number("max_angular_degps", &drive.max_angular_degps, 0.1..=3600.0)?;
    let (gain, spin) = (&drive.max_linear_acceleration_mps2, &drive.max_angular_acceleration_degps2);
    Ok(DriveLimits {
        max_linear_mps: table.number("max_linear_mps", &drive.max_linear_mps, 0.001..=fastest_mps)?,
        max_angular_radps: turn_degps.to_radians(),
        max_linear_acceleration_mps2: table.number("max_linear_acceleration_mps2", gain, 0.001..=100.0)?,
        max_angular_acceleration_radps2: table
            .number("max_angular_acceleration_degps2", spin, 0.1..=100_000.0)?
            .to_radians(),
    })
}

fn odometry(source: &Source<'_>, file: &OdometryFile) -> Result<OdometryError, WorldError> {
    let table = Table { source, path: "robot.odometry" };
    let per_m_deg = table.number_or("turn_per_m_deg", &file.turn_per_m_deg, 0.0, -90.0..=90.0)?;
    let noise_deg = table.number_or("turn_noise_deg", &file.turn_noise_deg, 0.0, 0.0..=90.0)?;
    Ok(OdometryError {
        distance_gain: table.number_or("distance_gain", &file.distance_gain, 0.0, -0.5..=0.5)?,
        turn_gain: table.number_or("turn_gain", &file.turn_gain, 0.0, -0.5..=0.5)?,
        turn_radpm: per_m_deg.to_radians(),
        distance_noise_m: table.number_or("distance_noise_m", &file.distance_noise_m, 0.0, 0.0..=1.0)?,
        turn_noise_rad: noise_deg.to_radians(),
    })
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

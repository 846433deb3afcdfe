//! A robot: its body and its odometry.

use super::behaviour::Context;
use super::check::Solid;
use super::drive::drive;
use super::file::{OdometryFile, RobotFile};
use super::laser::lasers;
use super::numbers::Table;
use super::{OdometryError, RobotSpec};
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
    let drive = drive(source, &file.drive, radius_m / step_s)?;
    let lasers = lasers(source, file, step_s, radius_m)?;
    let behaviour = Context { source, robot: file, start: at, drive: &drive, size, solids }.behaviour()?;
    let pose = pose(at.x, at.y, heading_deg.to_radians());
    let odometry = odometry(source, &file.odometry)?;
    let (laser, more_lasers) = lasers;
    Ok(RobotSpec { name, radius_m, mass_kg, pose, drive, odometry, laser, more_lasers, behaviour })
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

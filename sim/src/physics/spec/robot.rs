//! A robot: its body and its odometry.

use super::behaviour::Context;
use super::check::Solid;
use super::drive::drive;
use super::file::{OdometryFile, RobotFile};
use super::footprint::{Footprint, footprint};
use super::laser::lasers;
use super::numbers::Table;
use super::{OdometryError, RobotSpec, senses};
use crate::error::{Source, WorldError};
use crate::physics::convex;
use crate::physics::form::Form;
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
    let Footprint { radius_m, inner_m, corners, .. } = footprint(source, file)?;
    let mass_kg =
        file.mass_kg.as_ref().map(|mass| table.number("mass_kg", mass, 0.001..=100_000.0)).transpose()?;
    let at = table.point("pose_m", &file.pose_m, size)?;
    let heading_deg = table.number_or("heading_deg", &file.heading_deg, 0.0, -360.0..=360.0)?;
    let pose = pose(at.x, at.y, heading_deg.to_radians());
    let form = Form::new(&corners, radius_m, &pose);
    let help = match &form {
        Form::Disc { .. } => format!("its middle must keep its radius of {radius_m} m away"),
        Form::Convex(_) => "its footprint may touch other things, but not overlap them".to_owned(),
    };
    let (low, high) = form.bounds();
    if low.coords.min().min((size - high).min()) < -TOUCH_M {
        let what = format!("the robot `{name}` reaches out of the map");
        return Err(source.error(&what, (file.pose_m.span(), "too near to the border"), &[], &help));
    }
    let stands_in = |solid: &&Solid| match &form {
        Form::Disc { .. } => solid.shape.distance_m(&at) < radius_m - TOUCH_M,
        Form::Convex(corners) => convex::gap_m(corners, &solid.shape.corners()) < -TOUCH_M,
    };
    if let Some(solid) = solids.iter().chain(movers).find(stands_in) {
        let what = format!("the robot `{name}` starts in a wall or an obstacle");
        let marks = [(solid.span.clone(), "in this one")];
        return Err(source.error(&what, (file.pose_m.span(), "stands here"), &marks, &help));
    }
    let drive = drive(source, &file.drive, inner_m / step_s)?;
    let lasers = lasers(source, file, step_s, radius_m)?;
    let behaviour =
        Context { source, robot: file, radius_m, start: at, drive: &drive, size, solids }.behaviour()?;
    let odometry = odometry(source, &file.odometry)?;
    let (laser, more_lasers) = lasers;
    Ok(RobotSpec {
        name,
        radius_m,
        corners,
        mass_kg,
        pose,
        drive,
        odometry,
        laser,
        more_lasers,
        bumper: file.bumper.as_ref().map(|file| senses::bumper(source, file)).transpose()?,
        sonars: senses::sonars(source, file.sonars.as_deref().unwrap_or_default(), step_s, radius_m)?,
        fiducial: file
            .fiducial
            .as_ref()
            .map(|file| senses::fiducial(source, file, step_s, radius_m))
            .transpose()?,
        tag: file.tag.as_ref().map(|tag| *tag.get_ref()),
        behaviour,
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

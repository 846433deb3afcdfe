//! A robot: its body and its odometry.

use super::behavior::Context;
use super::drive::drive;
use super::file::{OdometryFile, RobotFile};
use super::footprint::{Footprint, footprint};
use super::laser::lasers;
use super::numbers::Table;
use super::senses;
use super::space::{Around, Solid};
use crate::error::{Source, WorldError};
use crate::together::Together;
use interfaces::pose;
use nalgebra::Isometry2;
use sim::physics::shape::TOUCH_M;
use sim::physics::{DriveKind, DriveLimits, Form, OdometryError, RobotSpec, convex};

/// No robot is too fast for it: what others are judged by where a drive is wrong itself.
const BOUNDLESS: DriveLimits = DriveLimits {
    kind: DriveKind::Differential,
    max_linear_mps: 5.0,
    max_angular_radps: f64::INFINITY,
    max_linear_acceleration_mps2: f64::INFINITY,
    max_angular_acceleration_radps2: f64::INFINITY,
};

pub(super) fn robot(
    source: &Source<'_>,
    file: &RobotFile,
    around: &Around<'_>,
) -> Result<RobotSpec, WorldError> {
    let table = Table { source, path: "robot" };
    let footprint = footprint(source, file);
    // A robot whose size is wrong is not too fast for it as well, and its parts fit on it.
    let (radius_m, inner_m) = footprint
        .as_ref()
        .map_or((f64::INFINITY, f64::INFINITY), |footprint| (footprint.radius_m, footprint.inner_m));
    let step_s = around.step_s;
    let place = stands(source, file, around, footprint);
    let drive = drive(source, &file.drive, inner_m / step_s);
    let behavior = Context {
        source,
        robot: file,
        place: place.as_ref().ok().map(|(body, pose)| (body.radius_m, pose.translation.vector.into())),
        drive: drive.as_ref().unwrap_or(&BOUNDLESS),
        around,
    }
    .behavior();
    let all = (
        source.name("robot", &file.name),
        table.number_if("mass_kg", &file.mass_kg, 0.001..=100_000.0),
        place,
        drive,
        behavior,
        odometry(source, &file.odometry),
        lasers(source, file, step_s, radius_m),
    );
    let senses = (
        file.bumper.as_ref().map(|file| senses::bumper(source, file)).transpose(),
        senses::sonars(source, file.sonars.as_deref().unwrap_or_default(), step_s, radius_m),
        file.fiducial.as_ref().map(|file| senses::fiducial(source, file, step_s, radius_m)).transpose(),
    );
    let (all, (bumper, sonars, fiducial)) = (all.together(), senses.together()).together()?;
    let (name, mass_kg, (body, pose), drive, behavior, odometry, (laser, more_lasers)) = all;
    Ok(RobotSpec {
        name,
        radius_m: body.radius_m,
        corners: body.corners,
        mass_kg,
        pose,
        drive,
        odometry,
        laser,
        more_lasers,
        bumper,
        sonars,
        fiducial,
        tag: file.tag.as_ref().map(|tag| *tag.get_ref()),
        behavior,
    })
}

/// The body of the robot and where it stands: in the map, and clear of everything.
fn stands(
    source: &Source<'_>,
    file: &RobotFile,
    around: &Around<'_>,
    footprint: Result<Footprint, WorldError>,
) -> Result<(Footprint, Isometry2<f64>), WorldError> {
    let table = Table { source, path: "robot" };
    let (body, at, heading_deg) = (
        footprint,
        table.point("pose_m", &file.pose_m, &around.size),
        table.number_or("heading_deg", &file.heading_deg, 0.0, -360.0..=360.0),
    )
        .together()?;
    let (name, radius_m) = (file.name.get_ref(), body.radius_m);
    let pose = pose(at.x, at.y, heading_deg.to_radians());
    let form = Form::new(&body.corners, radius_m, &pose);
    let help = match &form {
        Form::Disc { .. } => format!("its middle must keep its radius of {radius_m} m away"),
        Form::Convex(_) => "its footprint may touch other things, but not overlap them".to_owned(),
    };
    let (low, high) = form.bounds();
    if low.coords.min().min((around.size - high).min()) < -TOUCH_M {
        let what = format!("the robot `{name}` reaches out of the map");
        return Err(source.error(&what, (file.pose_m.span(), "too near to the border"), &[], &help));
    }
    let stands_in = |solid: &&Solid| match &form {
        Form::Disc { .. } => solid.shape.distance_m(&at) < radius_m - TOUCH_M,
        Form::Convex(corners) => convex::gap_m(corners, &solid.shape.corners()) < -TOUCH_M,
    };
    if let Some(solid) = around.solids.iter().chain(around.movers).find(stands_in) {
        let what = format!("the robot `{name}` starts in a wall or an obstacle");
        let marks = [(solid.span.clone(), "in this one")];
        return Err(source.error(&what, (file.pose_m.span(), "stands here"), &marks, &help));
    }
    Ok((body, pose))
}

fn odometry(source: &Source<'_>, file: &OdometryFile) -> Result<OdometryError, WorldError> {
    let table = Table { source, path: "robot.odometry" };
    let (distance_gain, turn_gain, per_m_deg, distance_noise_m, noise_deg) = (
        table.number_or("distance_gain", &file.distance_gain, 0.0, -0.5..=0.5),
        table.number_or("turn_gain", &file.turn_gain, 0.0, -0.5..=0.5),
        table.number_or("turn_per_m_deg", &file.turn_per_m_deg, 0.0, -90.0..=90.0),
        table.number_or("distance_noise_m", &file.distance_noise_m, 0.0, 0.0..=1.0),
        table.number_or("turn_noise_deg", &file.turn_noise_deg, 0.0, 0.0..=90.0),
    )
        .together()?;
    Ok(OdometryError {
        distance_gain,
        turn_gain,
        turn_radpm: per_m_deg.to_radians(),
        distance_noise_m,
        turn_noise_rad: noise_deg.to_radians(),
    })
}

//! A robot: its body and its pose.

use super::behavior::{self, Driver};
use super::drive::{self, drive};
use super::footprint::{Footprint, footprint};
use super::odometry::odometry;
use super::sensor::{Carrier, bumper};
use super::space::Space;
use crate::reader::Table;
use interfaces::pose;
use nalgebra::Isometry2;
use sim::physics::shape::TOUCH_M;
use sim::physics::{DriveKind, DriveLimits, Form, Rectangle, RobotSpec, convex};

pub(super) const KEYS: &str = "name, radius_m, footprint_m, mass_kg, pose_m, heading_deg, drive, odometry, laser, \
                               bumper, sonar, fiducial, tag, behaviour";

/// The limits by which a behavior is judged if those of the drive are invalid: nothing is too fast for them.
const BOUNDLESS: DriveLimits = DriveLimits {
    kind: DriveKind::Differential,
    max_linear_mps: 5.0,
    max_angular_radps: f64::INFINITY,
    max_linear_acceleration_mps2: f64::INFINITY,
    max_angular_acceleration_radps2: f64::INFINITY,
};

pub(super) fn robot(table: &Table<'_>, space: &Space) -> Option<RobotSpec> {
    let name = table.name();
    let called = name.as_deref().unwrap_or_default();
    let footprint = footprint(table, called);
    // A robot whose size is invalid is not too fast for it as well, and its parts fit on it.
    let (radius_m, inner_m) = footprint
        .as_ref()
        .map_or((f64::INFINITY, f64::INFINITY), |footprint| (footprint.radius_m, footprint.inner_m));
    let carrier = Carrier { step_s: space.step_s, radius_m };
    let mass_kg = table.number_if("mass_kg", 0.001..=100_000.0);
    let body = body(table, called, space, footprint);
    let drive = table.table("drive", drive::KEYS).and_then(|table| drive(&table, inner_m / space.step_s));
    let odometry = odometry(table);
    let lasers = carrier.lasers(table, called);
    let bumper = bumper(table);
    let sonars = carrier.sonars(table);
    let fiducial = carrier.fiducial(table);
    let tag = table.tag();
    let driver = Driver {
        robot: table,
        name: called,
        start: body.as_ref().map(|(body, pose)| (body.radius_m, pose.translation.vector.into())),
        drive: drive.as_ref().unwrap_or(&BOUNDLESS),
        space,
    };
    let behavior = table.table("behaviour", behavior::KEYS).and_then(|table| driver.behavior(&table));
    let ((body, pose), (laser, more_lasers)) = (body?, lasers?);
    table.sound(RobotSpec {
        radius_m: body.radius_m,
        corners: body.corners,
        mass_kg: mass_kg?,
        pose,
        drive: drive?,
        odometry: odometry?,
        laser,
        more_lasers,
        bumper: bumper?,
        sonars: sonars?,
        fiducial: fiducial?,
        tag: tag?,
        behavior: behavior?,
        name: name?,
    })
}

/// The body of the robot and its pose at the start: in the map, and clear of everything.
fn body(
    table: &Table<'_>,
    name: &str,
    space: &Space,
    footprint: Option<Footprint>,
) -> Option<(Footprint, Isometry2<f64>)> {
    let at = table.needed("pose_m").and_then(|value| value.point(&space.size));
    let heading_deg = table.number_or("heading_deg", 0.0, -360.0..=360.0);
    let (body, at, heading_deg) = (footprint?, at?, heading_deg?);
    let radius_m = body.radius_m;
    let pose = pose(at.x, at.y, heading_deg.to_radians());
    let form = Form::new(&body.corners, radius_m, &pose);
    let help = match &form {
        Form::Disc { .. } => format!("its middle must keep its radius of {radius_m} m away"),
        Form::Convex(_) => "its footprint may touch other things, but not overlap them".to_owned(),
    };
    let (low, high) = form.bounds();
    if low.coords.min().min((space.size - high).min()) < -TOUCH_M {
        let what = format!("the robot `{name}` reaches out of the map");
        return table.error(&what, (table.at("pose_m"), "too near to the border"), &[], &help);
    }
    let overlaps = |shape: &Rectangle| match &form {
        Form::Disc { .. } => shape.distance_m(&at) < radius_m - TOUCH_M,
        Form::Convex(corners) => convex::gap_m(corners, &shape.corners()) < -TOUCH_M,
    };
    if let Some(solid) = space.first_solid(overlaps).or_else(|| space.movers.first(overlaps)) {
        let what = format!("the robot `{name}` starts in a wall or an obstacle");
        let others = [(solid.span.clone(), "in this one")];
        return table.error(&what, (table.at("pose_m"), "stands here"), &others, &help);
    }
    Some((body, pose))
}

//! A robot: its body and its pose.

use super::behavior::{self, Driver};
use super::drive::{self, drive};
use super::sensor::{Carrier, bumper};
use super::space::Space;
use crate::reader::{Table, Value, valid};
use crate::schedule::hours;
use calendar::Hours;
use interfaces::pose;
use nalgebra::{Isometry2, Point2};
use sim::physics::shape::TOUCH_M;
use sim::physics::{
    BehaviorSpec, DisplacementSpec, DriveKind, DriveLimits, Form, OdometryError, PatrolDaySpec, Rectangle,
    RobotSpec, convex,
};

pub(super) const KEYS: &str = "name, radius_m, footprint_m, mass_kg, pose_m, heading_deg, drive, odometry, laser, \
                               bumper, sonar, behavior, patrol";

/// The limits by which a behavior is judged if those of the drive are invalid: nothing is too fast for them.
const BOUNDLESS: DriveLimits = DriveLimits {
    kind: DriveKind::Differential,
    max_linear_mps: 5.0,
    max_angular_radps: f64::INFINITY,
    max_linear_acceleration_mps2: f64::INFINITY,
    max_angular_acceleration_radps2: f64::INFINITY,
    lateral_grip: DriveLimits::LATERAL_GRIP,
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
    let body = body(table, called, space, footprint);
    let drive = table.table("drive", drive::KEYS).and_then(|table| drive(&table, inner_m / space.step_s));
    let odometry = odometry(table);
    let lasers = carrier.lasers(table, called);
    let bumper = bumper(table);
    let sonars = carrier.sonars(table);
    let mass_kg = table.number_if("mass_kg", 0.001..=100_000.0);
    let driver = Driver {
        robot: table,
        name: called,
        start: body.as_ref().map(|(body, pose)| (body.radius_m, pose.translation.vector.into())),
        drive: drive.as_ref().unwrap_or(&BOUNDLESS),
        space,
    };
    let behavior = table.table("behavior", behavior::KEYS).and_then(|table| driver.behavior(&table));
    let patrol = patrol(table, called, space, &behavior);
    let ((body, pose), (laser, more_lasers)) = (body?, lasers?);
    table.sound(RobotSpec {
        radius_m: body.radius_m,
        corners: body.corners,
        mass_kg,
        pose,
        drive: drive?,
        odometry: odometry?,
        laser,
        more_lasers,
        bumper: bumper?,
        sonars: sonars?,
        behavior: behavior?,
        patrol: patrol?,
        name: name?,
    })
}

const PATROL_KEYS: &str = "share, battery_s, dock_m, busy";

/// The day of the robot `name`, which must be driven. `Some(None)`: it has none.
fn patrol(
    robot: &Table<'_>,
    name: &str,
    space: &Space,
    behavior: &Option<BehaviorSpec>,
) -> Option<Option<PatrolDaySpec>> {
    let Some(value) = robot.get("patrol") else { return Some(None) };
    let table = value.table(PATROL_KEYS)?;
    let share = table.number_or("share", 1.0, 0.0001..=1.0);
    let battery_s = table.number_or("battery_s", PatrolDaySpec::BATTERY_S, 60.0..=1e6);
    let dock = table.get("dock_m").map_or(Some(None), |value| value.point(&space.size).map(Some));
    let busy = table.get("busy").map_or(Some(Hours::never()), |value| hours(&value));
    let in_solid = |dock: &Point2<f64>| space.first_solid(|shape| shape.distance_m(dock) <= 0.0);
    if let Some(solid) = dock.flatten().as_ref().and_then(in_solid) {
        let what = format!("the dock of the robot `{name}` is in a wall or an obstacle");
        let others = [(solid.span.clone(), "in this one")];
        let help = "a robot at its dock is within 0.5 m of it";
        return table.error(&what, (table.at("dock_m"), "stands here"), &others, help);
    }
    if behavior.as_ref().is_some_and(|behavior| *behavior != BehaviorSpec::Driven) {
        let what = format!("the robot `{name}` has a patrol, and is not driven");
        let help = "leave `patrol` out, or give the robot `kind = \"driven\"`";
        return robot.error(&what, (value.span(), "this patrol"), &[], help);
    }
    table.sound(Some(PatrolDaySpec { dock: dock?, battery_s, share, busy: busy? }))
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
    let (body, at, heading_deg) = (footprint?, at?, valid(heading_deg)?);
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
    let overlaps = |shape: &Rectangle| form.gap_m(&shape.corners()) < -TOUCH_M;
    if let Some(solid) = space.first_solid(overlaps).or_else(|| space.movers.first(overlaps)) {
        let what = format!("the robot `{name}` starts in a wall or an obstacle");
        let others = [(solid.span.clone(), "in this one")];
        return table.error(&what, (table.at("pose_m"), "stands here"), &others, &help);
    }
    Some((body, pose))
}

const MAX_CORNERS: usize = 32;

/// The area of a robot's body.
pub(super) struct Footprint {
    /// The radius of the circle about its center that contains the body, m.
    pub(super) radius_m: f64,
    /// The radius of the circle about its center that is contained in the body, m.
    pub(super) inner_m: f64,
    /// The corners, counter-clockwise, m; empty for a circle.
    pub(super) corners: Vec<Point2<f64>>,
}

/// The outline of the robot `name`.
pub(super) fn footprint(table: &Table<'_>, name: &str) -> Option<Footprint> {
    match (table.has("radius_m"), table.get("footprint_m")) {
        (true, None) => {
            let radius_m = valid(table.number("radius_m", 0.02..=10.0))?;
            Some(Footprint { radius_m, inner_m: radius_m, corners: Vec::new() })
        }
        (false, Some(value)) => polygon(&value),
        _ => {
            let what = format!("the robot `{name}` needs one outline");
            let help = "give either `radius_m` or `footprint_m`";
            table.error(&what, (table.at("name"), "this robot"), &[], help)
        }
    }
}

fn polygon(value: &Value<'_, '_>) -> Option<Footprint> {
    let count = value.items()?.len();
    if !(3..=MAX_CORNERS).contains(&count) {
        let help = "it must have 3 to 32, as in `[[-0.2, -0.1], [0.3, 0.0], [-0.2, 0.1]]`";
        return value.invalid(&format!("has {count} corners"), "this footprint", help);
    }
    let mut corners = value.list(|corner| corner.pair_within(&(-10.0..=10.0)))?;
    // Either way around is fine.
    if convex::area(&corners) < 0.0 {
        corners.reverse();
    }
    let turn = |i: usize| {
        let [a, b, c] = [0, 1, 2].map(|k| corners[(i + k) % corners.len()]);
        (b - a).perp(&(c - b))
    };
    // Turning left at every corner, it may still go around twice.
    let turns: Vec<f64> = convex::sides(&corners).map(|(a, b)| libm::atan2((b - a).y, (b - a).x)).collect();
    let around: f64 =
        (0..turns.len()).map(|i| interfaces::wrap_rad(turns[(i + 1) % turns.len()] - turns[i])).sum();
    if (0..corners.len()).any(|i| turn(i) < 1e-6) || around > 7.0 {
        return value.invalid("is not convex", "this footprint", "every corner must point outwards");
    }
    let inner_m = -convex::disc_gap_m(&corners, &Point2::origin(), 0.0);
    if inner_m < 0.02 {
        let help = "the point that the robot turns about, [0, 0], must be 0.02 m within it or more";
        let what = "a robot turns about a point outside of itself";
        return value.error(what, "this footprint", help);
    }
    let radius_m = corners.iter().map(|corner| corner.coords.norm()).fold(0.0, f64::max);
    Some(Footprint { radius_m, inner_m, corners })
}

const ODOMETRY_KEYS: &str =
    "distance_gain, turn_gain, turn_per_m_deg, distance_noise_m, turn_noise_deg, slip, jump, carried";
const DISPLACEMENT_KEYS: &str = "every_s, distance_m, turn_deg";

pub(super) fn odometry(robot: &Table<'_>) -> Option<OdometryError> {
    let table = robot.table_or_empty("odometry", ODOMETRY_KEYS)?;
    let [jump, carried] = ["jump", "carried"].map(|key| displacement(&table, key));
    table.sound(OdometryError {
        distance_gain: table.number_or("distance_gain", 0.0, -0.5..=0.5),
        turn_gain: table.number_or("turn_gain", 0.0, -0.5..=0.5),
        turn_radpm: table.number_or("turn_per_m_deg", 0.0, -90.0..=90.0).to_radians(),
        distance_noise_m: table.number_or("distance_noise_m", 0.0, 0.0..=1.0),
        turn_noise_rad: table.number_or("turn_noise_deg", 0.0, 0.0..=90.0).to_radians(),
        slip: table.number_or("slip", 0.0, 0.0..=1.0),
        jump: jump?,
        carried: carried?,
    })
}

/// `Some(None)`: the key is not given.
fn displacement(odometry: &Table<'_>, key: &'static str) -> Option<Option<DisplacementSpec>> {
    let Some(value) = odometry.get(key) else { return Some(None) };
    let table = value.table(DISPLACEMENT_KEYS)?;
    let every_s = table.number("every_s", 0.1..=1e9);
    let distance_m = table.number_or("distance_m", 0.0, 0.0..=1000.0);
    let turn_deg = table.number_or("turn_deg", 0.0, 0.0..=180.0);
    if distance_m == 0.0 && turn_deg == 0.0 {
        let what = format!("`{}` displaces by nothing", odometry.path(key));
        let help = "give `distance_m` or `turn_deg` a value above 0, or leave the table out";
        return table.error(&what, (table.span.clone(), "no displacement"), &[], help);
    }
    table.sound(Some(DisplacementSpec { every_s, distance_m, turn_rad: turn_deg.to_radians() }))
}

//! From a Stage world to one that runs here.

use super::sources::{Place, Sources};
use super::toml::STEER_DEG;
use super::{Drive, StageRobot, StageWorld};
use crate::findings::Severity;
use crate::physics::FleetSpec;
use nalgebra::{Isometry2, Point2};
use std::f64::consts::PI;
use std::path::Path;

/// What touches may overlap by rounding, m.
const TOUCH_M: f64 = 1e-6;
/// More pieces of wall than this are refused: looking for what hides what takes their square.
const MAX_PIECES: usize = 20_000;
/// The fastest that a robot may be, m/s, the lightest, kg, and the smallest and largest, m.
const FASTEST_MPS: f64 = 5.0;
const LEAST_MASS_KG: f64 = 0.001;
const RADIUS_M: [f64; 2] = [0.02, 10.0];
/// A robot has no more lasers than this, nor sonars.
const MOST_SENSORS: usize = 100;
/// The least that a laser or a fiducial finder sees, rad: 1°.
const LEAST_FOV_RAD: f64 = PI / 180.0;

/// Makes a fleet of a Stage world. Whatever the physics cannot do is said at the line of the Stage
/// file.
pub(super) fn load(sources: &mut Sources<'_>, path: &Path, world: &StageWorld) -> Option<FleetSpec> {
    let pieces: usize = world.walls.iter().map(|wall| wall.rectangles.len()).sum();
    if pieces > MAX_PIECES {
        let what = format!("the walls of this world are of {pieces} pieces");
        let help = format!("{MAX_PIECES} are the most: take coarser pictures, or blocks with fewer corners");
        sources.findings.add_file(Severity::Error, path, &what, &help);
        return None;
    }
    for (index, robot) in world.robots.iter().enumerate() {
        check_drive(sources, robot);
        check_senses(sources, robot);
        check_place(sources, world, index);
    }
    if sources.findings.errors() > 0 {
        return None;
    }
    let name = format!("{}, made from {}", path.with_extension("toml").display(), path.display());
    match FleetSpec::parse(&name, &world.to_toml()) {
        Ok(spec) => Some(spec),
        Err(error) => {
            let help = "each line of the file made from it names the line that it comes from";
            sources.findings.add_file(Severity::Error, path, &error.to_string(), help);
            None
        }
    }
}

fn check_drive(sources: &mut Sources<'_>, robot: &StageRobot) {
    let (at, name) = (robot.at, &robot.name);
    let [back, forth] = robot.velocity.x;
    let [right, left] = robot.velocity.turn;
    let is_omni = robot.drive == Drive::Omni;
    if -back != forth || -right != left || is_omni && -robot.velocity.y[0] != robot.velocity.y[1] {
        let what = format!("`{name}` may drive or turn faster one way than the other");
        sources.warning(at, &what, "", "here the larger bound holds both ways");
    }
    let fastest_mps = forth.max(-back);
    if !(0.001..=FASTEST_MPS).contains(&fastest_mps) || left.max(-right) < 0.002 {
        let what =
            format!("`{name}` may drive at {fastest_mps} m/s and turn at {:.4} rad/s", left.max(-right));
        sources.error(
            at,
            &what,
            "",
            "robots drive at 0.001 to 5 m/s and turn at 0.002 rad/s or more; see `velocity_bounds`",
        );
    }
    if let Drive::Car { .. } = robot.drive {
        let help = format!("here they turn by up to {STEER_DEG}°, and the car obeys commands");
        sources.warning(at, &format!("Stage does not bound how far the wheels of `{name}` turn"), "", &help);
    }
    let sideways_mps = robot.velocity.y[1].max(-robot.velocity.y[0]);
    if is_omni && !(0.001..=FASTEST_MPS).contains(&sideways_mps) {
        let what = format!("`{name}` may drive sideways at {sideways_mps} m/s");
        sources.error(at, &what, "", "it is 0.001 to 5 m/s; see `velocity_bounds`");
    }
    if robot.mass_kg.is_some_and(|mass_kg| mass_kg < LEAST_MASS_KG) {
        let help = format!("a robot weighs {LEAST_MASS_KG} kg or more");
        sources.error(at, &format!("`{name}` weighs next to nothing"), "", &help);
    }
    let radius_m = robot.radius_m();
    if !(RADIUS_M[0]..=RADIUS_M[1]).contains(&radius_m) {
        let what = format!("`{name}` has a radius of {radius_m:.3} m");
        sources.error(at, &what, "", "robots have a radius of 0.02 to 10 m");
    }
}

/// Whether its sensors can be what they are meant to be.
fn check_senses(sources: &mut Sources<'_>, robot: &StageRobot) {
    let radius_m = robot.radius_m();
    let mut check = |at: Place, what: &str, mount: &Isometry2<f64>, range_max_m: f64, is_fine: bool| {
        if mount.translation.vector.norm() > radius_m {
            let what = format!("a {what} of `{}` is mounted off its robot", robot.name);
            sources.error(at, &what, "", "it must lie above the robot's body");
        }
        if !(0.01..=1000.0).contains(&range_max_m) || !is_fine {
            let help = "it sees over 1° or more, up to 0.01 to 1000 m, with a noise of at most 1 m";
            sources.error(at, &format!("a {what} of `{}` is out of range", robot.name), "", help);
        }
    };
    for laser in &robot.lasers {
        let is_fine = laser.fov_rad >= LEAST_FOV_RAD && laser.noise_std_m <= 1.0;
        check(laser.at, "laser", &laser.mount, laser.range_max_m, is_fine);
    }
    for sonar in &robot.sonars {
        check(sonar.at, "sonar", &sonar.mount, sonar.range_max_m, sonar.noise_std_m <= 1.0);
    }
    if let Some(finder) = &robot.fiducial {
        let is_fine = finder.fov_rad >= LEAST_FOV_RAD;
        check(finder.at, "fiducial finder", &finder.mount, finder.range_max_m, is_fine);
    }
    for (what, count) in [("lasers", robot.lasers.len()), ("sonars", robot.sonars.len())] {
        if count > MOST_SENSORS {
            let what = format!("`{}` has {count} {what}", robot.name);
            sources.error(robot.at, &what, "", &format!("{MOST_SENSORS} are the most"));
        }
    }
    if robot.lasers.is_empty() {
        let help =
            "every robot has one here: it is given a laser of 180 beams over 180°, up to 8 m, at 10 Hz";
        sources.warning(robot.at, &format!("`{}` has no laser", robot.name), "", help);
    }
}

/// Whether a robot stands in a wall or in another robot.
fn check_place(sources: &mut Sources<'_>, world: &StageWorld, index: usize) {
    let robot = &world.robots[index];
    let form = robot.form();
    let stands_in = |wall: &&super::StageWall| {
        let mut rectangles = wall.rectangles.iter().filter(|rectangle| {
            let middle = Point2::from(robot.pose.translation.vector);
            rectangle.distance_m(&middle) < robot.radius_m()
        });
        rectangles.any(|rectangle| form.gap_m(&rectangle.corners()) < -TOUCH_M)
    };
    if let Some(wall) = world.walls.iter().find(stands_in) {
        let what = format!("the robot `{}` stands in `{}`", robot.name, wall.name);
        let help = format!("it may touch, but not overlap, {}", wall.place);
        sources.error(robot.at, &what, "", &help);
    }
    for other in &world.robots[..index] {
        let apart_m = (other.pose.translation.vector - robot.pose.translation.vector).norm();
        if apart_m < robot.radius_m() + other.radius_m() && form.apart_m(&other.form()) < -TOUCH_M {
            let what = format!("the robots `{}` and `{}` overlap", other.name, robot.name);
            let help = format!("they may touch, but not overlap; the other one is at {}", other.place);
            sources.error(robot.at, &what, "", &help);
        }
    }
}

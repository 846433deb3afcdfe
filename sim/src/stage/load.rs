//! From a Stage world to one that runs here.

use super::sources::Sources;
use super::toml::STEER_DEG;
use super::{Drive, StageRobot, StageWorld};
use crate::findings::Severity;
use crate::physics::FleetSpec;
use nalgebra::Point2;
use std::path::Path;

/// What touches may overlap by rounding, m.
const TOUCH_M: f64 = 1e-6;
/// More pieces of wall than this are refused: looking for what hides what takes their square.
const MAX_PIECES: usize = 20_000;
/// The fastest that a robot may be, m/s, the lightest, kg, and the smallest and largest, m.
const FASTEST_MPS: f64 = 5.0;
const LEAST_MASS_KG: f64 = 0.001;
const RADIUS_M: [f64; 2] = [0.02, 10.0];

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
        check_lasers(sources, robot);
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
    } else if !robot.is_round() {
        let help = format!(
            "here it is a disc of {radius_m:.3} m about the point that it turns about, which holds all of it"
        );
        sources.warning(at, &format!("`{name}` is not round"), "", &help);
    }
}

fn check_lasers(sources: &mut Sources<'_>, robot: &StageRobot) {
    let (at, name) = (robot.at, &robot.name);
    if robot.lasers.is_empty() {
        let help =
            "every robot has one here: it is given a laser of 180 beams over 180°, up to 8 m, at 10 Hz";
        return sources.warning(at, &format!("`{name}` has no laser"), "", help);
    }
    for laser in &robot.lasers {
        if laser.mount.translation.vector.norm() > robot.radius_m() {
            let what = format!("a laser of `{name}` is mounted off its robot");
            sources.error(laser.at, &what, "", "it must lie above the robot's body");
        }
        if laser.range_max_m > 1000.0 || laser.fov_rad < 1.0_f64.to_radians() || laser.noise_std_m > 1.0 {
            let help = "a laser sees over 1° or more, up to 1000 m, with a noise of at most 1 m";
            sources.error(laser.at, &format!("a laser of `{name}` is out of range"), "", help);
        }
    }
}

/// Whether a robot stands in a wall or in another robot.
fn check_place(sources: &mut Sources<'_>, world: &StageWorld, index: usize) {
    let robot = &world.robots[index];
    let (middle, radius_m) = (Point2::from(robot.pose.translation.vector), robot.radius_m());
    let stands_in = |wall: &&super::StageWall| {
        wall.rectangles.iter().any(|rectangle| rectangle.distance_m(&middle) < radius_m - TOUCH_M)
    };
    if let Some(wall) = world.walls.iter().find(stands_in) {
        let what = format!("the robot `{}` stands in `{}`", robot.name, wall.name);
        let help = format!("its middle must keep {radius_m:.3} m away from {}", wall.place);
        sources.error(robot.at, &what, "", &help);
    }
    for other in &world.robots[..index] {
        let apart_m = (other.pose.translation.vector - robot.pose.translation.vector).norm();
        let needed_m = radius_m + other.radius_m();
        if apart_m < needed_m - TOUCH_M {
            let what = format!("the robots `{}` and `{}` overlap", other.name, robot.name);
            let help = format!(
                "their middles must be {needed_m:.3} m apart or more, not {apart_m:.3} m; the other one is at {}",
                other.place
            );
            sources.error(robot.at, &what, "", &help);
        }
    }
}

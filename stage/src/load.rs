//! From a Stage world to one that runs here.

use super::sources::Sources;
use super::to_toml::STEER_DEG;
use super::{Drive, StageRobot, StageWorld};
use nalgebra::Point2;
use sim::physics::FleetSpec;
use std::path::Path;
use worldfile::Severity;
use worldfile::physics::{MAX_OUT_M, MAX_PIECES, parse_fleet};
use worldfile::toml_value::short;

/// Makes a fleet of a Stage world. An error names the line of the Stage file.
pub(super) fn load(sources: &mut Sources<'_>, path: &Path, world: &StageWorld) -> Option<FleetSpec> {
    check(sources, world);
    if sources.findings.errors() > 0 {
        return None;
    }
    let name = format!("{}, made from {}", path.with_extension("toml").display(), path.display());
    let made = world.made();
    let spec = parse_fleet(&name, &made.text).map_err(|error| {
        // The user has not seen the made file: its errors are reported where its tables and keys come from.
        for finding in error.findings().iter() {
            match made.origin(finding.line) {
                Some(at) => sources.error(at, &finding.what, &finding.help),
                None => sources.add_file(Severity::Error, &finding.what, &finding.help),
            }
        }
    });
    let low = world.map_origin();
    if spec.is_ok() && low != Point2::origin() {
        let (x, y) = (short(low.x), short(low.y));
        let what = format!("[0, 0] of the world that runs is [{x}, {y}] of this file");
        let help = "it is the lower left corner of all that is there; headings are as in the file";
        sources.add_file(Severity::Note, what, help);
    }
    spec.ok()
}

// What the physics simulates differently from Stage, reported at the line of the Stage file.

/// Adds a warning for everything that the physics simulates differently, and an error if there are too many walls.
pub(super) fn check(sources: &mut Sources<'_>, world: &StageWorld) {
    let pieces: usize = world.walls.iter().map(|wall| wall.rectangles.len()).sum();
    if pieces > MAX_PIECES {
        let what = format!("the walls of this world are of {pieces} pieces");
        let help = format!("{MAX_PIECES} are the most: take coarser pictures, or blocks with fewer corners");
        sources.add_file(Severity::Error, what, help);
    }
    for robot in &world.robots {
        warn_of_drive(sources, robot);
        warn_of_sensors(sources, robot);
    }
}

fn warn_of_drive(sources: &mut Sources<'_>, robot: &StageRobot) {
    let name = &robot.name;
    let is_lopsided = |[least, most]: [f64; 2]| -least != most;
    let (velocity, is_omni) = (&robot.velocity, robot.drive == Drive::Omni);
    if is_lopsided(velocity.x) || is_lopsided(velocity.turn) || is_omni && is_lopsided(velocity.y) {
        let what = format!("`{name}` may drive or turn faster one way than the other");
        sources.warning(robot.key("velocity_bounds"), what, "here the larger bound holds both ways");
    }
    if let Drive::Car { .. } = robot.drive {
        let what = format!("Stage does not bound how far the wheels of `{name}` turn");
        let help = format!("here they turn by up to {STEER_DEG}°, and the car obeys commands");
        sources.warning(robot.at, what, help);
    }
}

fn warn_of_sensors(sources: &mut Sources<'_>, robot: &StageRobot) {
    let (radius_m, name) = (robot.radius_m(), &robot.name);
    for (kind, sensor) in robot.sensors() {
        let off_m = sensor.mount.translation.vector.norm() - radius_m;
        if off_m > MAX_OUT_M {
            let what = format!("a {kind} of `{name}` is mounted {off_m:.3} m off its robot");
            let help = format!(
                "here it is moved back, straight towards the point that the robot turns about, to {MAX_OUT_M} m from \
                 the circle about the body: it measures from there"
            );
            sources.warning(robot.at, what, help);
        }
    }
    if robot.lasers.is_empty() {
        let help =
            "every robot has one here: it is given a laser of 180 beams over 180°, up to 8 m, at 10 Hz";
        sources.warning(robot.at, format!("`{name}` has no laser"), help);
    }
}

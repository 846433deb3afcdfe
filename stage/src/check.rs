//! What the physics simulates differently from Stage, reported at the line of the Stage file.

use super::sources::Sources;
use super::to_toml::STEER_DEG;
use super::{Drive, StageRobot, StageWorld};
use worldfile::Severity;
use worldfile::physics::{MAX_OUT_M, MAX_PIECES};

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

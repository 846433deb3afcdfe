//! Small worlds in which a robot once stood for minutes, each with one cause.

use super::{LONGEST_S, longest};
use sim::physics::FleetSpec;

/// A room of 4 m × 3 m with further parts, and a robot of 0.4 m.
fn room(parts: &str, at_m: [f64; 2], heading_deg: f64, behavior: &str) -> FleetSpec {
    let wall = |min: [f64; 2], max: [f64; 2]| format!("[[wall]]\nmin_m = {min:?}\nmax_m = {max:?}\n");
    let walls = wall([0.0, 0.0], [4.0, 0.1])
        + &wall([0.0, 2.9], [4.0, 3.0])
        + &wall([0.0, 0.1], [0.1, 2.9])
        + &wall([3.9, 0.1], [4.0, 2.9]);
    let text = format!(
        "name = \"room\"\n[map]\nsize_m = [4.0, 3.0]\ncell_m = 0.1\n{walls}{parts}[[robot]]\nname = \"walker\"\n\
         radius_m = 0.2\nmass_kg = 15.0\npose_m = {at_m:?}\nheading_deg = {heading_deg:?}\n[robot.drive]\n\
         max_linear_mps = 0.8\nmax_angular_degps = 120.0\nmax_linear_acceleration_mps2 = 1.0\n\
         max_angular_acceleration_degps2 = 360.0\n[robot.laser]\nbeams = 90\nrange_max_m = 4.0\nrate_hz = 10.0\n\
         [robot.behavior]\nspeed_mps = 0.3\n{behavior}\n"
    );
    worldfile::physics::parse_fleet("room.toml", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// The longest stand in 20 minutes of a world, with some seeds.
fn check(spec: &FleetSpec) {
    for seed in 0..4 {
        let run = longest(spec, seed, 1200.0, false);
        assert!(run.stood_s < LONGEST_S, "{run:?}");
    }
}

/// All waypoints are behind a wall that appears, and the way round it leads away from them: detours of some seconds
/// ended before the slow turn in the narrow place had found the way out, and the robot turned back to the wall.
#[test]
fn a_robot_leaves_a_narrow_place_although_all_its_waypoints_are_behind_a_wall() {
    let alcove = "[[obstacle]]\nname = \"side\"\nmin_m = [1.3, 0.1]\nmax_m = [1.4, 0.6]\n\
                  [[obstacle]]\nname = \"wall\"\nmin_m = [1.9, 0.1]\nmax_m = [2.0, 2.1]\nappears_s = 0.1\n";
    let way = "kind = \"waypoints\"\npoints_m = [[3.0, 0.4], [3.5, 0.4], [3.5, 0.8]]";
    check(&room(alcove, [1.65, 0.36], 0.0, way));
}

/// The robot is in an alcove that is a little wider than itself: it drove some centimeters, was blocked by a side,
/// turned the long way round, drove back, and so on.
#[test]
fn a_wandering_robot_leaves_an_alcove() {
    let side = "[[wall]]\nmin_m = [3.1, 2.4]\nmax_m = [3.44, 2.9]\n";
    check(&room(side, [3.67, 2.66], 90.0, "kind = \"wander\""));
}

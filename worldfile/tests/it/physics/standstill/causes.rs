//! Small worlds in which a robot once stood for minutes, each with one cause.

use super::super::{parse_fleet, wall};
use super::worlds::body;
use super::{LONGEST_S, longest};
use sim::physics::FleetSpec;

/// A room of 4 m × 3 m with further parts, and a robot of 0.4 m.
fn room(parts: &str, at_m: [f64; 2], heading_deg: f64, behavior: &str) -> FleetSpec {
    let walls = wall([0.0, 0.0], [4.0, 0.1])
        + &wall([0.0, 2.9], [4.0, 3.0])
        + &wall([0.0, 0.1], [0.1, 2.9])
        + &wall([3.9, 0.1], [4.0, 2.9]);
    let text = format!(
        "name = \"room\"\n[map]\nsize_m = [4.0, 3.0]\ncell_m = 0.1\n{walls}{parts}{}speed_mps = 0.3\n",
        body("walker", 0.2, at_m, heading_deg, behavior)
    );
    parse_fleet(&text)
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
    let way = "\"waypoints\"\npoints_m = [[3.0, 0.4], [3.5, 0.4], [3.5, 0.8]]";
    check(&room(alcove, [1.65, 0.36], 0.0, way));
}

/// The robot is in an alcove that is a little wider than itself: it drove some centimeters, was blocked by a side,
/// turned the long way round, drove back, and so on.
#[test]
fn a_wandering_robot_leaves_an_alcove() {
    let side = "[[wall]]\nmin_m = [3.1, 2.4]\nmax_m = [3.44, 2.9]\n";
    check(&room(side, [3.67, 2.66], 90.0, "\"wander\""));
}

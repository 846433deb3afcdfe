//! Bodies that are in each other's way are separated, and continue.

use super::fleet::at;
use super::things::pushed;
use super::*;

/// A hall of 20 m × 4 m, with further parts.
fn hall(step_s: f64, things: &str) -> Fleet {
    let text = format!(
        "name = \"hall\"\n[map]\nsize_m = [20.0, 4.0]\ncell_m = 0.1\n[physics]\nstep_s = {step_s:?}\n{things}"
    );
    Fleet::new(&parse_fleet(&text), 0)
}

/// A fast robot with its heading along x.
pub(super) fn robot(name: &str, body: &str, mass_kg: f64, at: [f64; 2]) -> String {
    format!(
        "[[robot]]\nname = \"{name}\"\n{body}\nmass_kg = {mass_kg:?}\npose_m = {at:?}\nbehavior = {{ kind = \"driven\" }}\n\
         drive = {{ max_linear_mps = 1.0, max_angular_degps = 180.0, max_linear_acceleration_mps2 = 5.0, max_angular_acceleration_degps2 = 720.0 }}\n\
         laser = {{ beams = 2, range_max_m = 5.0, rate_hz = 10.0 }}\n"
    )
}

/// The distance along x that the first robot covers in 4 s, driving at 1 m/s and turning at the commanded rate.
fn way_m(mut fleet: Fleet, turn: impl Fn(usize) -> f64) -> f64 {
    let from = at(&fleet, 0).x;
    fleet.run_until(4.0, &mut |robot: &RobotView<'_>, _: &LaserReading| Twist {
        linear_mps: 1.0,
        angular_radps: turn(robot.index),
    });
    at(&fleet, 0).x - from
}

/// A corridor of a width along the lower end of the hall.
fn corridor(width_m: f64) -> String {
    wall([0.0, 0.0], [20.0, 0.1]) + &wall([0.0, 0.1 + width_m], [20.0, 0.2 + width_m])
}

const RECTANGLE: &str = "footprint_m = [[-0.3, -0.2], [0.3, -0.2], [0.3, 0.2], [-0.3, 0.2]]";

#[test]
fn a_row_of_boxes_goes_on_before_a_heavy_robot() {
    for step_s in [0.1, 0.05, 0.02] {
        let boxes: String = (0..3)
            .map(|i| {
                let at = [1.7 + 0.35 * f64::from(i), 2.0 + 0.02 * f64::from(i)];
                let turned = format!("heading_deg = {}\nmass_kg", 7 * i);
                pushed(&format!("b{i}"), at, 1.0, 0.0).replace("mass_kg", &turned)
            })
            .collect();
        let fleet = hall(step_s, &(boxes + &robot("r", "radius_m = 0.2", 20.0, [1.0, 2.0])));
        let way_m = way_m(fleet, |_| 0.0);
        assert!(way_m > 3.5, "{way_m} m at steps of {step_s} s");
    }
}

#[test]
fn robots_side_by_side_in_a_corridor_get_along() {
    let bodies = [RECTANGLE, "footprint_m = [[-0.25, -0.2], [0.4, 0.0], [-0.25, 0.2]]"];
    for (step_s, body) in [0.1, 0.05, 0.02].into_iter().flat_map(|step_s| bodies.map(|body| (step_s, body))) {
        let robots = robot("a", body, 20.0, [1.0, 0.31]) + &robot("b", body, 0.5, [1.0, 0.72]);
        // Each turns toward the other.
        let way_m =
            way_m(hall(step_s, &(corridor(0.83) + &robots)), |robot| if robot == 0 { 0.5 } else { -0.5 });
        assert!(way_m > 2.0, "{way_m} m at steps of {step_s} s, {body}");
    }
}

#[test]
fn a_light_box_between_a_robot_and_a_wall_does_not_stop_it() {
    for step_s in [0.1, 0.05] {
        let things = pushed("b", [1.6, 0.69], 0.02, 0.3) + &robot("r", RECTANGLE, 20.0, [1.0, 0.317]);
        let way_m = way_m(hall(step_s, &(corridor(0.75) + &things)), |_| 0.087);
        assert!(way_m > 2.0, "{way_m} m at steps of {step_s} s");
    }
}

//! Slip in contacts, and motion without contacts, with steps of any length.

use super::specs::four_rooms;
use super::*;
use interfaces::{Twist, pose};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// A robot with limits of speed (m/s) and acceleration (m/s²), at a place (m) with a heading (°).
fn robot([x, y, heading_deg]: [f64; 3], [speed_mps, gain_mps2]: [f64; 2], mass_kg: f64) -> RobotSpec {
    let mut robot = RobotSpec::new("robot", pose(x, y, heading_deg.to_radians()), BehaviorSpec::Driven);
    robot.mass_kg = Some(mass_kg);
    robot.drive.max_linear_mps = speed_mps;
    robot.drive.max_linear_acceleration_mps2 = gain_mps2;
    robot
}

/// The first of these robots drives at full speed with steps of `step_s`.
fn driving(robots: Vec<RobotSpec>, step_s: f64, contacts: ContactModel) -> Fleet {
    let spec = FleetSpec { step_s, contacts, robots, ..four_rooms() };
    let mut fleet = Fleet::new(&spec, 0);
    fleet.command(0, Twist { linear_mps: 9.0, angular_radps: 0.0 });
    fleet
}

fn at(fleet: &Fleet, robot: usize) -> Vector2<f64> {
    fleet.robot(robot).unwrap().pose.translation.vector
}

fn assert_near(found: f64, expected: f64, share: f64, case: &str) {
    assert!((found - expected).abs() <= share * expected.abs(), "{case}: {found}, not {expected}");
}

#[test]
fn a_robot_slides_along_a_wall_at_the_same_speed_with_every_step() {
    for contacts in [ContactModel::RigidBodies, ContactModel::Sliding] {
        for limits in [[0.5, 1.0], [0.3, 2.0], [0.8, 0.5]] {
            for angle_deg in [15.0_f64, 30.0, 45.0, 60.0, 75.0] {
                let (sin, cos) = angle_deg.to_radians().sin_cos();
                let expected_mps = cos * f64::min(limits[0], limits[1] * 0.05 / (sin * sin));
                for step_s in [0.05, 0.02, 0.005] {
                    let case = format!("{contacts:?}, {limits:?}, {angle_deg}°, {step_s} s");
                    let wall = robot([0.6, 0.31, -angle_deg], limits, 1.0);
                    let mut fleet = driving(vec![wall], step_s, contacts);
                    fleet.run_until(5.0, &mut ());
                    let before = at(&fleet, 0);
                    fleet.run_until(6.0, &mut ());
                    assert_near(at(&fleet, 0).x - before.x, expected_mps, 0.02, &case);
                    assert!((0.2996..0.3002).contains(&at(&fleet, 0).y), "{case}: {}", at(&fleet, 0).y);
                    assert!(fleet.robot(0).unwrap().is_stalled, "{case}");
                }
            }
        }
    }
}

#[test]
fn a_robot_that_is_pushed_sideways_moves_as_far_with_every_step() {
    for masses_kg in [[1.0, 1.0], [3.0, 1.0], [1.0, 3.0], [20.0, 1.0]] {
        for limits in [[0.5, 1.0], [0.3, 2.0]] {
            for heading_deg in [90.0, 45.0] {
                let moved_m = |step_s: f64| {
                    let pushed = robot([1.5, 2.0, heading_deg], limits, masses_kg[1]);
                    let robots = vec![robot([0.6, 2.0, 0.0], limits, masses_kg[0]), pushed];
                    let mut fleet = driving(robots, step_s, ContactModel::RigidBodies);
                    fleet.run_until(5.0, &mut ());
                    (at(&fleet, 1) - Vector2::new(1.5, 2.0)).norm()
                };
                let case = format!("{masses_kg:?}, {limits:?}, {heading_deg}°");
                assert_near(moved_m(0.05), moved_m(0.005), 0.05, &case);
            }
        }
    }
}

#[test]
fn a_robot_with_less_lateral_grip_is_pushed_farther() {
    let moved_m = [10.0, 0.5, 0.05, 0.0].map(|lateral_grip| {
        let mut pushed = robot([1.5, 2.0, 90.0], [0.5, 1.0], 1.0);
        pushed.drive.lateral_grip = lateral_grip;
        let robots = vec![robot([0.6, 2.0, 0.0], [0.5, 1.0], 1.0), pushed];
        let mut fleet = driving(robots, 0.05, ContactModel::RigidBodies);
        fleet.run_until(5.0, &mut ());
        at(&fleet, 1).x - 1.5
    });
    assert!(
        moved_m[0] <= moved_m[1] && moved_m[1] + 0.1 < moved_m[2] && moved_m[2] < moved_m[3],
        "{moved_m:?}"
    );
}

#[test]
fn without_contacts_a_robot_moves_by_its_velocity_to_a_nanometer() {
    for contacts in [ContactModel::RigidBodies, ContactModel::Sliding] {
        // Through a door, 10 m.
        let mut fleet = driving(vec![robot([0.8, 3.0, 0.0], [0.5, 1e9], 1.0)], 0.001, contacts);
        fleet.run_until(20.0, &mut ());
        assert!((at(&fleet, 0) - Vector2::new(10.8, 3.0)).norm() < 1e-9, "{}", at(&fleet, 0));
        // A full circle with a radius of 1 m.
        for step_s in [0.05, 0.001] {
            let mut circling = robot([3.0, 2.0, 0.0], [TAU / 20.0, 1e9], 1.0);
            circling.drive.max_angular_acceleration_radps2 = 1e9;
            let mut fleet = driving(vec![circling], step_s, contacts);
            fleet.command(0, Twist { linear_mps: 9.0, angular_radps: TAU / 20.0 });
            fleet.run_until(10.0, &mut ());
            assert!((at(&fleet, 0) - Vector2::new(3.0, 4.0)).norm() < 3e-5, "{}", at(&fleet, 0));
            fleet.run_until(20.0, &mut ());
            assert!((at(&fleet, 0) - Vector2::new(3.0, 2.0)).norm() < 1e-9, "{}", at(&fleet, 0));
        }
    }
}

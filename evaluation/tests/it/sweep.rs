//! A laser that sweeps, against a laser of the same world that measures all beams at once.

use interfaces::{LaserReading, Twist, World};
use localizer::GivenPoses;
use sim::physics::{OdometryError, PhysicsWorld, WorldSpec};
use std::f64::consts::TAU;

/// A house in which only the driven robot moves, with a laser without noise.
fn world(sweep_s: f64) -> PhysicsWorld {
    let house = WorldSpec::generate_house(1003);
    let mut fleet = house.fleet().clone();
    fleet.obstacles.clear();
    fleet.robots = vec![fleet.robots.swap_remove(house.driven_index())];
    let robot = &mut fleet.robots[0];
    robot.odometry = OdometryError::default();
    let laser = &mut robot.laser;
    (laser.beams, laser.fov_rad, laser.noise_std_m, laser.sweep_s) = (720, TAU, 0.0, sweep_s);
    PhysicsWorld::new(&WorldSpec::driving(fleet, 0).expect("a robot"), 1)
}

/// The largest error of 98 % of the ranges, m, and the number of ranges without an error of their own.
fn errors(undone: &LaserReading, at_once: &LaserReading) -> (f64, usize) {
    let ranges = undone.scan.ranges_m.iter().zip(&at_once.scan.ranges_m);
    let measured = ranges.filter(|(undone, expected)| undone.is_finite() && expected.is_finite());
    let mut errors_m: Vec<f32> = measured.map(|(undone, expected)| (undone - expected).abs()).collect();
    errors_m.sort_by(f32::total_cmp);
    (errors_m[(errors_m.len() - 1) * 98 / 100].into(), errors_m.len())
}

#[test]
fn an_undone_sweep_is_the_scan_that_is_measured_at_once() {
    let (mut sweeping, mut at_once) = (world(0.1), world(0.0));
    let mut poses = GivenPoses::default();
    let mut ignored_m: f64 = 0.0;
    for step in 0..100 {
        let (swept, expected) = (sweeping.sense(), at_once.sense());
        assert_eq!(swept.pose, expected.pose);
        ignored_m = ignored_m.max(errors(&swept, &expected).0);
        let (error_m, beams) = errors(&poses.deskewed(swept), &expected);
        // The robot turns by up to a seventieth of a turn in a scan, and edges are not measured.
        assert!(error_m < 0.01 && beams > 680, "scan {step}: {error_m} m, {beams} beams");
        let command = Twist {
            linear_mps: if step / 10 % 2 == 0 { 0.3 } else { 0.0 },
            angular_radps: [0.0, 1.0, -1.0, 0.5][step / 7 % 4],
        };
        sweeping.act(&command);
        at_once.act(&command);
    }
    assert!(ignored_m > 0.1, "nothing to undo: {ignored_m} m");
}

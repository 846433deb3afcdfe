//! Odometry that slips, jumps, and does not notice that the robot is carried away.

use super::fleet::{house, robot};
use super::*;
use interfaces::{heading_rad, wrap_rad};
use nalgebra::Isometry2;

/// A robot at [3, 1.5] among others, with errors of its odometry.
fn place(error: &str, others: &[String]) -> FleetSpec {
    let errors = format!("[robot.odometry]\n{error}\n[robot.drive]");
    let own = robot("own", [3.0, 1.5], 0.0, "kind = \"driven\"").replace("[robot.drive]", &errors);
    house(&[&[own], others].concat(), "")
}

/// The true pose and the reading at every scan of some seconds under one command.
fn run(spec: &FleetSpec, twist: Twist, seconds: f64) -> Vec<(Isometry2<f64>, LaserReading)> {
    let mut fleet = Fleet::new(spec, 8);
    let mut seen = Vec::new();
    fleet.run_until(seconds, &mut |robot: &RobotView<'_>, reading: &LaserReading| {
        seen.push((robot.pose, reading.clone()));
        twist
    });
    seen
}

/// How far apart two poses are, m and rad.
fn apart(a: &Isometry2<f64>, b: &Isometry2<f64>) -> (f64, f64) {
    let distance_m = (a.translation.vector - b.translation.vector).norm();
    (distance_m, wrap_rad(heading_rad(a) - heading_rad(b)).abs())
}

fn truths(seen: &[(Isometry2<f64>, LaserReading)]) -> Vec<Isometry2<f64>> {
    seen.iter().map(|(pose, _)| *pose).collect()
}

#[test]
fn wheels_that_slip_drive_on_against_a_wall() {
    // From x = 3 to the wall at x = 5.95 it is 2.75 m, which takes 6 s.
    let ahead = Twist { linear_mps: 0.5, angular_radps: 0.0 };
    let [whole, half, none] =
        ["slip = 1.0", "slip = 0.5", "slip = 0.0"].map(|error| run(&place(error, &[]), ahead, 20.0));
    assert_eq!(truths(&whole), truths(&none));
    assert_eq!(truths(&half), truths(&none));
    assert!((whole[199].0.translation.x - 5.75).abs() < 0.01);
    // Free wheels: 0.5 m/s for 19.9 s, less the half of 0.5 s of acceleration.
    for (seen, share) in [(&whole, 1.0), (&half, 0.5), (&none, 0.0)] {
        let expected_m = 2.75 + share * (0.5 * 19.9 - 0.125 - 2.75);
        let measured_m = seen[199].1.pose.translation.x - 3.0;
        assert!((measured_m - expected_m).abs() < 0.05, "{measured_m} m, not {expected_m} m");
        let speed_mps = seen[199].1.twist.linear_mps;
        assert!((speed_mps - share * 0.5).abs() < 0.05, "{speed_mps} m/s");
        // Before the wall, nothing slips.
        assert!(seen[..50].iter().all(|(pose, reading)| apart(pose, &reading.pose).0 < 1e-6));
    }
}

#[test]
fn a_robot_at_rest_that_is_pushed_away_measures_nothing_if_its_wheels_slip() {
    let pusher =
        robot("pusher", [2.0, 1.5], 0.0, "kind = \"circle\"\nspeed_mps = 0.5\nturn_radius_m = 1000.0")
            .replace("radius_m = 0.2", "mass_kg = 50.0\nradius_m = 0.2");
    let seen = run(&place("slip = 1.0", &[pusher]), Twist::STOP, 5.0);
    let (truth, reading) = &seen[49];
    assert!(truth.translation.x > 3.5, "{truth}");
    assert!((reading.pose.translation.x - 3.0).abs() < 0.02, "{}", reading.pose);
}

#[test]
fn jumps_change_the_odometry_and_not_the_truth() {
    let turn = Twist { linear_mps: 0.2, angular_radps: 0.4 };
    let jump = "jump = { every_s = 2.0, distance_m = 0.8, turn_deg = 30.0 }";
    let (jumping, exact) = (run(&place(jump, &[]), turn, 400.0), run(&place("", &[]), turn, 400.0));
    assert_eq!(truths(&jumping), truths(&exact));
    let mut jumps = Vec::new();
    for pair in jumping.windows(2) {
        let [(before, measured_before), (after, measured)] = pair else { unreachable!() };
        let wanted = measured_before.pose * (before.inverse() * after);
        let (distance_m, turn_rad) = apart(&measured.pose, &wanted);
        if distance_m > 1e-6 || turn_rad > 1e-6 {
            jumps.push((distance_m, turn_rad));
        }
    }
    // A Poisson process: 200 ± 14, of which some fall between the same two scans.
    assert!((150..240).contains(&jumps.len()), "{}", jumps.len());
    let most = |of: fn(&(f64, f64)) -> f64| jumps.iter().map(of).fold(0.0, f64::max);
    // Two in one interval may add up.
    assert!((0.6..1.6).contains(&most(|jump| jump.0)), "{jumps:?}");
    assert!((0.4..1.05).contains(&most(|jump| jump.1)), "{jumps:?}");
    // Half of a disc lies within 0.71 of its radius.
    jumps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let median_m = jumps[jumps.len() / 2].0;
    assert!((median_m - 0.8 * 0.5_f64.sqrt()).abs() < 0.1, "{median_m}");
}

#[test]
fn a_carried_robot_is_elsewhere_and_does_not_notice() {
    let spec = place(
        "carried = { every_s = 2.0, distance_m = 3.0, turn_deg = 180.0 }",
        &[robot("other", [2.0, 2.0], 0.0, "kind = \"wander\"\nspeed_mps = 0.3")],
    );
    let mut fleet = Fleet::new(&spec, 8);
    let (mut carried, mut longest_m, mut rooms) = (0, 0.0_f64, [false; 4]);
    let mut before: Option<(Isometry2<f64>, Isometry2<f64>)> = None;
    for _ in 0..8000 {
        fleet.step(&mut always(0.3, 0.3));
        let own = fleet.robots().next().unwrap();
        let measured = own.reading().unwrap().pose;
        let at = own.pose.translation.vector;
        if let Some((pose, odometry)) = before {
            let (moved_m, turned_rad) = apart(&own.pose, &pose);
            if moved_m > 0.05 || turned_rad > 0.2 {
                carried += 1;
                longest_m = longest_m.max(moved_m);
                // At rest, and in nothing.
                assert_eq!(own.twist, Twist::STOP);
                assert!(wall_m(&spec, &at.into()) > 0.199, "{at}");
                let other = fleet.robots().nth(1).unwrap().pose;
                assert!((other.translation.vector - at).norm() > 0.399, "{at}");
            }
            // 0.1 s at 0.3 m/s, at most.
            let (measured_m, measured_rad) = apart(&measured, &odometry);
            assert!(measured_m < 0.035 && measured_rad < 0.035, "{measured_m} m, {measured_rad} rad");
        }
        assert!(at.x > 0.0 && at.x < 12.0 && at.y > 0.0 && at.y < 12.0, "{at}");
        rooms[usize::from(at.x > 6.0) + 2 * usize::from(at.y > 6.0)] = true;
        before = Some((own.pose, measured));
    }
    assert!((150..250).contains(&carried), "{carried}");
    assert!((2.5..3.02).contains(&longest_m), "{longest_m}");
    assert_eq!(rooms, [true; 4]);
}

#[test]
fn a_world_says_whether_its_poses_are_exact() {
    let says = |error: &str| {
        let spec = WorldSpec::new(place(error, &[])).unwrap();
        PhysicsWorld::new(&spec, 0).poses_are_exact()
    };
    assert!(says("slip = 0.0"));
    for error in ["turn_gain = 0.01", "slip = 1.0", "carried = { every_s = 9.0, distance_m = 1.0 }"] {
        assert!(!says(error), "{error}");
    }
}

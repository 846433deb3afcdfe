use super::*;
use interfaces::LaserReading;

fn run(spec: &WorldSpec, seed: u64, steps: usize) -> Vec<LaserReading> {
    let mut world = PhysicsWorld::new(spec, seed);
    let mut readings = vec![world.sense()];
    for step in 0..steps {
        let angular_radps = libm::sin(step as f64 * 0.05);
        world.act(&Twist { linear_mps: 0.4, angular_radps });
        readings.push(world.sense());
    }
    readings
}

fn noisy() -> WorldSpec {
    let odometry = "[robot.odometry]\ndistance_noise_m = 0.01\nturn_noise_deg = 1.0\n\n[robot.laser]";
    four_rooms_but(&[("noise_std_m = 0.0 ", "noise_std_m = 0.01 "), ("[robot.laser]", odometry)], "")
}

#[test]
fn every_scan_is_whole_and_makes_sense() {
    let spec = noisy();
    for reading in run(&spec, 3, 100) {
        assert_eq!(reading.scan.check(), Ok(()));
        assert_eq!(reading.scan.ranges_m.len(), spec.driven().laser.beams);
        assert!(reading.scan.is_full_turn());
        let max_m = spec.driven().laser.range_max_m as f32;
        let sensible = |range: &f32| (0.0..=max_m).contains(range) || *range == f32::INFINITY;
        assert!(reading.scan.ranges_m.iter().all(sensible));
    }
}

#[test]
fn the_seed_matters_only_with_noise() {
    assert_eq!(run(&four_rooms(), 1, 50), run(&four_rooms(), 2, 50));
    let [one, other] = [1, 2].map(|seed| run(&noisy(), seed, 50));
    assert_ne!(one[0].scan, other[0].scan);
    assert_ne!(one[50].pose, other[50].pose);
}

#[test]
fn noise_has_its_standard_deviation() {
    let (exact, noisy) = (run(&four_rooms(), 1, 0), run(&noisy(), 1, 0));
    let pairs = exact[0].scan.ranges_m.iter().zip(&noisy[0].scan.ranges_m);
    let seen = pairs.filter(|(a, b)| a.is_finite() && b.is_finite());
    let errors: Vec<f64> = seen.map(|(a, b)| f64::from(b - a)).collect();
    assert!(errors.len() > 600);
    let std_m = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
    assert!((std_m - 0.01).abs() < 0.001, "{std_m}");
}

#[test]
fn exact_odometry_is_the_truth_and_drifting_odometry_drifts() {
    let twist = Twist { linear_mps: 0.5, angular_radps: 0.5 };
    let mut exact = PhysicsWorld::new(&four_rooms(), 0);
    drive(&mut exact, twist, 10.0, |_| ());
    assert_eq!(exact.sense().pose, *exact.true_pose());

    let gains = "[robot.odometry]\ndistance_gain = 0.1\nturn_gain = 0.05\n\n[robot.laser]";
    let mut drifting = PhysicsWorld::new(&four_rooms_but(&[("[robot.laser]", gains)], ""), 0);
    drive(&mut drifting, twist, 10.0, |_| ());
    let reading = drifting.sense();
    assert_eq!(drifting.true_pose(), exact.true_pose());
    assert!((reading.twist.linear_mps - 0.55).abs() < 1e-5);
    // Both robots started with heading 0, and reached full speed within the first step.
    let felt_rad = interfaces::heading_rad(&reading.pose);
    assert!(interfaces::wrap_rad(felt_rad - 1.05 * 0.5 * 10.0).abs() < 1e-3, "{felt_rad}");
}

/// A minute of the four rooms with noise, bit by bit. If this number changes, the world has changed: this must be
/// intended.
#[test]
fn golden_hash() {
    let bits = |reading: LaserReading| {
        let at = reading.pose.translation.vector;
        let pose = [reading.time_s, at.x, at.y, reading.pose.rotation.im].map(f64::to_bits);
        pose.into_iter().chain(reading.scan.ranges_m.into_iter().map(|range_m| range_m.to_bits().into()))
    };
    let hash = crate::fnv(run(&noisy(), 42, 600).into_iter().flat_map(bits));
    assert_eq!(hash, 5_089_696_961_613_030_344);
}

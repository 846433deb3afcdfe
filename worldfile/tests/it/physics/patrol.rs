use super::*;
use proptest::prelude::*;

const FAR: &str = "pose_m = [2.0, 2.0]";

/// The position of the dummy robot along its path, and the error of its distance to the wall, m.
fn dummy(world: &PhysicsWorld) -> (f64, f64) {
    let at = super::fleet::at(world.fleet(), 1);
    (at.x, at.y - 11.5)
}

/// The ends at which the dummy robot turned in some seconds, m.
fn turns(world: &mut PhysicsWorld, seconds: f64) -> Vec<f64> {
    let mut path = vec![dummy(world).0];
    drive(world, Twist::STOP, seconds, |world| path.push(dummy(world).0));
    path.dedup_by(|a, b| (*a - *b).abs() < 1e-3);
    let turning = |w: &[f64]| (w[1] - w[0]) * (w[2] - w[1]) < 0.0;
    path.windows(3).filter(|w| turning(w)).map(|w| w[1]).collect()
}

#[test]
fn it_goes_back_and_forth_between_its_points() {
    let mut world = PhysicsWorld::new(&four_rooms(), 0);
    let turns = turns(&mut world, 120.0);
    // 4 m at 0.3 m/s take 13.3 s, and a turn in place a few more.
    assert!((6..=9).contains(&turns.len()), "{turns:?}");
    for (i, turn) in turns.iter().enumerate() {
        let end = if i % 2 == 0 { 11.2 } else { 7.2 };
        assert!((turn - end).abs() < 0.03, "{turns:?}");
    }
}

#[test]
fn it_keeps_its_distance_to_the_wall_and_finds_back_to_it() {
    // 4 cm off at the start is what the check allows.
    for (noise, y) in [("0.0", "11.5"), ("0.03", "11.5"), ("0.0", "11.46")] {
        let plain = "range_max_m = 5.0\nrate_hz = 10.0\nnoise_std_m = 0.0";
        let noisy = plain.replace("std_m = 0.0", &format!("std_m = {noise}"));
        let start = format!("pose_m = [7.2, {y}]");
        let spec = four_rooms_but(&[(plain, &noisy), ("pose_m = [7.2, 11.5]", &start)], "");
        let mut world = PhysicsWorld::new(&spec, 0);
        drive(&mut world, Twist::STOP, if y == "11.5" { 0.0 } else { 10.0 }, |_| ());
        drive(&mut world, Twist::STOP, 60.0, |world| {
            let (_, off_m) = dummy(world);
            assert!(off_m.abs() < 0.02, "{off_m} m off its way with noise {noise}, from {y}");
        });
    }
}

#[test]
fn it_stops_for_the_standing_robot_and_goes_on_when_that_has_gone() {
    // In the way of the robot, and more or less beside it.
    for y in ["11.5", "11.3", "11.15", "11.09", "11.05"] {
        let start = format!("pose_m = [9.5, {y}]");
        let mut world = PhysicsWorld::new(
            &four_rooms_but(&[(FAR, &start), ("heading_deg = 0.0", "heading_deg = 270.0")], ""),
            0,
        );
        let mut closest_m = f64::INFINITY;
        let contacts =
            drive(&mut world, Twist::STOP, 40.0, |world| closest_m = closest_m.min(bodies_apart_m(world)));
        assert!(closest_m > 0.02, "{closest_m} m apart at y = {y}");
        assert_eq!(contacts, []);
        let (x, _) = dummy(&world);
        if y != "11.05" {
            assert!(x < 9.2, "it passed through at y = {y}");
            assert_eq!(drive(&mut world, Twist::STOP, 5.0, |_| ()), []);
            assert_eq!(dummy(&world).0, x, "it does not stand still");
        }
        let mut contacts = drive(&mut world, Twist { linear_mps: 0.5, angular_radps: 0.0 }, 3.0, |_| ());
        contacts.extend(drive(&mut world, Twist::STOP, 1.0, |_| ()));
        let mut farthest = f64::NEG_INFINITY;
        contacts
            .extend(drive(&mut world, Twist::STOP, 30.0, |world| farthest = farthest.max(dummy(world).0)));
        assert!(farthest > 11.15, "it did not go on: {farthest} at y = {y}");
        assert_eq!(contacts, []);
    }
}

#[test]
fn it_stops_for_an_obstacle_and_goes_on_when_that_has_gone() {
    for (min, max) in
        [("[9.0, 11.4]", "[9.4, 11.6]"), ("[9.0, 11.7]", "[9.4, 11.9]"), ("[9.0, 11.2]", "[9.4, 11.32]")]
    {
        let obstacle = format!(
            "[[obstacle]]\nname = \"box\"\nmin_m = {min}\nmax_m = {max}\nappears_s = 1.0\ndisappears_s = 20.0"
        );
        let mut world = PhysicsWorld::new(&four_rooms_but(&[], &obstacle), 0);
        drive(&mut world, Twist::STOP, 20.0, |world| {
            let standing = world.fleet().obstacles().count() == 1;
            let gap_m = world.spec().obstacles[0].shape.distance_m(&super::fleet::at(world.fleet(), 1)) - 0.2;
            assert!(!standing || gap_m > 0.02, "{gap_m} m from the box at {min}");
        });
        let (x, _) = dummy(&world);
        assert!((8.3..9.0).contains(&x), "it stopped too early or not at all: {x}");
        drive(&mut world, Twist::STOP, 9.0, |_| ());
        assert!(dummy(&world).0 > 10.5, "it did not go on");
    }
}

#[test]
fn a_thing_behind_the_end_of_its_way_does_not_stop_it() {
    let obstacle = "[[obstacle]]\nname = \"box\"\nmin_m = [11.5, 11.4]\nmax_m = [11.9, 11.9]";
    let mut world = PhysicsWorld::new(&four_rooms_but(&[], obstacle), 0);
    assert!(turns(&mut world, 60.0).len() >= 3);
}

#[test]
fn a_laser_off_the_middle_serves_as_well() {
    let mount = "range_max_m = 5.0\nmount_m = [0.1, 0.05]\nmount_deg = 40.0";
    let start = "pose_m = [9.5, 11.4]";
    let mut world = PhysicsWorld::new(&four_rooms_but(&[("range_max_m = 5.0", mount), (FAR, start)], ""), 0);
    let contacts = drive(&mut world, Twist::STOP, 30.0, |world| assert!(dummy(world).1.abs() < 0.01));
    assert_eq!(contacts, []);
    assert!(dummy(&world).0 > 8.8);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..Default::default() })]

    #[test]
    fn it_never_bumps_into_a_robot_that_stands(x in 6.3..11.6_f64, y in 10.5..11.65_f64, noise in 0.0..0.02_f64) {
        let mut text = FOUR_ROOMS.replacen(FAR, &format!("pose_m = [{x}, {y}]"), 1);
        text = text.replace("rate_hz = 10.0\nnoise_std_m = 0.0", &format!("rate_hz = 10.0\nnoise_std_m = {noise}"));
        let Ok(spec) = worldfile::physics::parse_world("test.toml", &text) else { return Err(TestCaseError::reject("overlap")) };
        let mut world = PhysicsWorld::new(&spec, 0);
        // It may pass at a distance of a few millimeters, or stand there from the start: it must not touch.
        let least_m = bodies_apart_m(&world).min(0.001) - 1e-6;
        let contacts = drive(&mut world, Twist::STOP, 60.0, |world| assert!(bodies_apart_m(world) > least_m));
        prop_assert_eq!(contacts, []);
    }
}

//! Bumpers and sonars.

use super::fleet::{house, robot};
use super::snapshot::sensed;
use super::*;

pub(super) const SENSES: &str = "[robot.bumper]\nsectors = 4\nfov_deg = 180.0\n\
    [[robot.sonar]]\ncone_deg = 30.0\nrange_max_m = 5.0\nrate_hz = 10.0\n\
    [[robot.sonar]]\ncone_deg = 30.0\nrange_max_m = 5.0\nrate_hz = 5.0\nmount_deg = 90.0\nnoise_std_m = 0.02\n[robot.behavior]";

/// A robot at [1, 2] with all sensors, and further keys.
fn place(more: &[String], things: &str) -> FleetSpec {
    let one = robot("one", [1.0, 2.0], 0.0, "kind = \"driven\"").replace("[robot.behavior]", SENSES);
    let robots: Vec<String> = [one].into_iter().chain(more.iter().cloned()).collect();
    house(&robots, things)
}

fn standing(name: &str, at: [f64; 2]) -> String {
    robot(name, at, 0.0, "kind = \"standing\"")
}

#[test]
fn a_sonar_hears_the_nearest_thing_in_its_cone() {
    // 0.5 m beside its axis, 2 m ahead: 14° off it; and one that is nearer, but beside the cone.
    let others = [standing("in", [3.0, 2.5]), standing("beside", [2.0, 2.9])];
    let mut fleet = Fleet::new(&place(&others, ""), 0);
    fleet.step(&mut ());
    let robot = fleet.robot(0).unwrap();
    let readings: Vec<SonarReading> = robot.sonars().flatten().collect();
    // The beam nearest to its middle may pass that by a quarter of a degree.
    let expected_m = libm::hypot(2.0, 0.5) - 0.2;
    assert!((f64::from(readings[0].range_m) - expected_m).abs() < 1e-3, "{readings:?}");
    assert_eq!(readings[0].time_s, 0.0);
    // To the left the border of its cone meets the outer wall, 0.9 m beside it.
    let exact_m = (0.9 / libm::sin(15.0_f64.to_radians())) as f32;
    assert!((readings[1].range_m - exact_m).abs() < 0.1 && readings[1].range_m != exact_m, "{readings:?}");
    fleet.run_until(0.15, &mut ());
    let times: Vec<f64> = fleet.robot(0).unwrap().sonars().flatten().map(|reading| reading.time_s).collect();
    assert!((times[0] - 0.1).abs() < 1e-9 && times[1] == 0.0, "{times:?}");
}

#[test]
fn a_sonar_hears_farther_than_the_laser_sees() {
    let mut spec = place(&[], "");
    spec.robots[0].laser.range_max_m = 0.5;
    (spec.robots[0].sonars[0].range_max_m, spec.robots[0].sonars[0].cone_rad) = (10.0, 0.02);
    let mut fleet = Fleet::new(&spec, 0);
    fleet.step(&mut ());
    let reading = fleet.robot(0).unwrap().sonars().next().flatten().unwrap();
    // From x = 1 to the wall between the rooms.
    assert!((reading.range_m - 4.95).abs() < 1e-3, "{reading:?}");
}

#[test]
fn bumpers_feel_where_they_are_touched() {
    for (turn_deg, sector) in [(0.0, 2), (30.0, 1), (-30.0, 2), (60.0, 0), (-60.0, 3)] {
        let text = place(&[], "");
        let mut fleet = Fleet::new(&text, 0);
        // The outer wall on the left ends at 0.1 m: it drives into it, turned.
        let heading: f64 = std::f64::consts::PI + f64::to_radians(turn_deg);
        fleet.teleport(0, &interfaces::pose(0.305, 3.0, heading)).unwrap();
        assert!(!fleet.robot(0).unwrap().bumpers().any(|pressed| pressed));
        let mut felt = vec![false; 4];
        for _ in 0..20 {
            fleet.step(&mut always(0.5, 0.0));
            felt.iter_mut()
                .zip(fleet.robot(0).unwrap().bumpers())
                .for_each(|(felt, pressed)| *felt |= pressed);
        }
        if turn_deg == 0.0 {
            // Straight ahead two of them meet.
            assert!(felt[1] || felt[2], "{felt:?}");
        } else {
            let expected: Vec<bool> = (0..4).map(|i| i == sector).collect();
            assert_eq!(felt, expected, "turned by {turn_deg}°");
        }
    }
}

#[test]
fn a_flat_touch_presses_every_bumper_along_it_until_they_part() {
    let square = |heading_deg: f64| {
        let robot = robot("one", [5.4, 1.5], heading_deg, "kind = \"driven\"")
            .replace("[robot.drive]", "[robot.drive]\nkind = \"omni\"\nmax_left_mps = 0.5")
            .replace("radius_m = 0.2", "footprint_m = [[-0.2, -0.2], [0.2, -0.2], [0.2, 0.2], [-0.2, 0.2]]");
        // Three sectors of 32° each, right, middle and left; the front is nearly as wide as all of them.
        let bumper = "[robot.bumper]\nsectors = 3\nfov_deg = 96.0\n[robot.behavior]";
        house(&[robot.replace("[robot.behavior]", bumper)], "")
    };
    let mut fleet = Fleet::new(&square(0.0), 0);
    let pressed = |fleet: &Fleet| fleet.robot(0).unwrap().bumpers().collect::<Vec<_>>();
    fleet.run_until(2.0, &mut always(0.5, 0.0));
    assert_eq!(pressed(&fleet), [true; 3]);
    assert_eq!(fleet.contacts().len(), 1);
    assert_eq!(fleet.robot(0).unwrap().touching, [fleet.contacts()[0].with]);
    // At rest against the wall the bumper still detects the contact.
    fleet.run_until(4.0, &mut always(0.0, 0.0));
    assert_eq!(pressed(&fleet), [true; 3]);
    assert_eq!(fleet.contacts(), []);
    fleet.run_until(5.0, &mut always(-0.5, 0.0));
    assert_eq!(pressed(&fleet), [false; 3]);
    // With a corner ahead it is that of the corner alone.
    let mut fleet = Fleet::new(&square(45.0), 0);
    fleet.run_until(3.0, &mut |_: &RobotView<'_>, _: &LaserReading| Velocity {
        forward_mps: libm::sqrt(0.5) * 0.2,
        left_mps: -libm::sqrt(0.5) * 0.2,
        turn_radps: 0.0,
    });
    assert_eq!(pressed(&fleet), [true, false, false]);
}

/// A reading is computed when it is first read, if at all: this never shows.
#[test]
fn readings_do_not_depend_on_which_readings_were_read() {
    let driven = robot("one", [1.0, 2.0], 0.0, "kind = \"driven\"").replace("[robot.behavior]", SENSES);
    let free = robot("free", [4.0, 2.0], 1.0, "kind = \"wander\"\nspeed_mps = 0.3");
    let robots = [driven, standing("other", [2.0, 2.0]), free];
    let robots =
        robots.map(|robot| robot.replace("noise_std_m = 0.005\n", "noise_std_m = 0.005\ndropout = 0.1\n"));
    let spec = house(&robots, "");
    let [mut read, mut unread] = [Fleet::new(&spec, 3), Fleet::new(&spec, 3)];
    // Reads nothing.
    struct Ahead;
    impl Controller for Ahead {
        fn drive(&mut self, _: &RobotView<'_>) -> Option<Velocity> {
            Some(Twist { linear_mps: 0.3, angular_radps: 0.2 }.into())
        }
    }
    for step in 0..60 {
        read.step(&mut Ahead);
        unread.step(&mut Ahead);
        let all = sensed(&read);
        if step % 17 == 0 {
            // The robots have moved since the readings that are computed only now.
            assert_eq!(sensed(&unread), all);
            assert_eq!(unread.snapshot(), read.snapshot());
        }
    }
    for fleet in [&mut read, &mut unread] {
        fleet.teleport(0, &interfaces::pose(1.5, 3.0, 0.0)).unwrap();
    }
    let mut restored = Fleet::restored(&spec, &unread.snapshot()).unwrap();
    for fleet in [&mut read, &mut unread, &mut restored] {
        fleet.run_until(5.0, &mut Ahead);
    }
    assert_eq!(sensed(&unread), sensed(&read));
    assert_eq!([unread.snapshot(), restored.snapshot()], [read.snapshot(), read.snapshot()]);
}

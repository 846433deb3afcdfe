//! Sonars, and readings that are computed on demand.

use super::fleet::{house, robot};
use super::*;
use interfaces::LaserReading;

const SENSES: &str = "[[robot.sonar]]\ncone_deg = 30.0\nrange_max_m = 5.0\nrate_hz = 10.0\n\
    [[robot.sonar]]\ncone_deg = 30.0\nrange_max_m = 5.0\nrate_hz = 5.0\nmount_deg = 90.0\nnoise_std_m = 0.02\n\
    [robot.behavior]";

/// A robot at [1, 2] with all sensors, and further keys.
fn place(more: &[String], things: &str) -> FleetSpec {
    let one = robot("one", [1.0, 2.0], 0.0, "kind = \"driven\"").replace("[robot.behavior]", SENSES);
    let robots: Vec<String> = [one].into_iter().chain(more.iter().cloned()).collect();
    house(&robots, things)
}

fn stop(_: &RobotView<'_>, _: &LaserReading) -> Twist {
    Twist::STOP
}

fn standing(name: &str, at: [f64; 2]) -> String {
    robot(name, at, 0.0, "kind = \"standing\"")
}

#[test]
fn a_sonar_hears_the_nearest_thing_in_its_cone() {
    // 0.5 m beside its axis, 2 m ahead: 14° off it; and one that is nearer, but beside the cone.
    let others = [standing("in", [3.0, 2.5]), standing("beside", [2.0, 2.9])];
    let mut fleet = Fleet::new(&place(&others, ""), 0);
    fleet.step(&mut stop);
    let robot = fleet.robots().next().unwrap();
    let readings: Vec<SonarReading> = robot.sonars().flatten().collect();
    // The beam nearest to its middle may pass that by a quarter of a degree.
    let expected_m = libm::hypot(2.0, 0.5) - 0.2;
    assert!((f64::from(readings[0].range_m) - expected_m).abs() < 1e-3, "{readings:?}");
    assert_eq!(readings[0].time_s, 0.0);
    // To the left the border of its cone meets the outer wall, 0.9 m beside it.
    let exact_m = (0.9 / libm::sin(15.0_f64.to_radians())) as f32;
    assert!((readings[1].range_m - exact_m).abs() < 0.1 && readings[1].range_m != exact_m, "{readings:?}");
    fleet.run_until(0.15, &mut stop);
    let times: Vec<f64> =
        fleet.robots().next().unwrap().sonars().flatten().map(|reading| reading.time_s).collect();
    assert!((times[0] - 0.1).abs() < 1e-9 && times[1] == 0.0, "{times:?}");
}

#[test]
fn a_sonar_hears_farther_than_the_laser_sees() {
    let mut spec = place(&[], "");
    spec.robots[0].laser.range_max_m = 0.5;
    (spec.robots[0].sonars[0].range_max_m, spec.robots[0].sonars[0].cone_rad) = (10.0, 0.02);
    let mut fleet = Fleet::new(&spec, 0);
    fleet.step(&mut stop);
    let reading = fleet.robots().next().unwrap().sonars().next().flatten().unwrap();
    // From x = 1 to the wall between the rooms.
    assert!((reading.range_m - 4.95).abs() < 1e-3, "{reading:?}");
}

#[test]
fn a_snapshot_knows_what_was_sensed() {
    let mut fleet = Fleet::new(&place(&[standing("other", [2.0, 2.0])], ""), 3);
    let mut ahead = |_: &RobotView<'_>, _: &LaserReading| Twist { linear_mps: 0.5, angular_radps: 0.1 };
    fleet.run_until(1.25, &mut ahead);
    let snapshot = fleet.snapshot();
    let mut again = Fleet::restored(fleet.spec(), &snapshot).unwrap();
    let sensed = |fleet: &Fleet| fleet.robots().next().unwrap().sonars().collect::<Vec<_>>();
    assert_eq!(sensed(&again), sensed(&fleet));
    for fleet in [&mut fleet, &mut again] {
        fleet.run_until(4.0, &mut ahead);
    }
    assert_eq!(again.snapshot(), fleet.snapshot());
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
    let sensed = |fleet: &Fleet| -> Vec<String> {
        let sensed = |robot: RobotView<'_>| {
            format!("{:?} {:?}", robot.lasers().collect::<Vec<_>>(), robot.sonars().collect::<Vec<_>>())
        };
        fleet.robots().map(sensed).collect()
    };
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

/// A controller that reads nothing.
struct Ahead;

impl Controller for Ahead {
    fn drive(&mut self, _: &RobotView<'_>) -> Option<Velocity> {
        Some(Twist { linear_mps: 0.3, angular_radps: 0.2 }.into())
    }
}

//! Drives of every kind.

use super::fleet::{house, robot};
use super::*;
use nalgebra::Isometry2;

/// A controller that always gives the same command.
fn say(command: Velocity) -> impl FnMut(&RobotView<'_>, &LaserReading) -> Velocity {
    move |_, _| command
}

/// A robot at [3, 3] with a drive of some kind, alone.
fn alone(drive: &str) -> Fleet {
    let robot = robot("one", [3.0, 3.0], 0.0, "kind = \"driven\"");
    let robot = robot.replace("[robot.drive]", &format!("[robot.drive]\n{drive}"));
    Fleet::new(&house(&[robot], ""), 0)
}

const KINDS: [&str; 3] =
    ["kind = \"diff\"", "kind = \"omni\"\nmax_left_mps = 0.3", "kind = \"car\"\nwheelbase_m = 0.4"];

fn now(fleet: &Fleet) -> (Isometry2<f64>, Velocity) {
    let robot = fleet.robots().next().unwrap();
    let Twist { linear_mps, angular_radps } = robot.twist;
    (robot.pose, Velocity { forward_mps: linear_mps, left_mps: robot.left_mps, turn_radps: angular_radps })
}

#[test]
fn bounds_hold_under_every_command_of_every_drive() {
    let (inf, nan) = (f64::INFINITY, f64::NAN);
    let numbers = [
        (0.4, 0.1, 1.0),
        (-0.4, -0.9, 3.0),
        (inf, inf, -inf),
        (nan, 0.0, 0.0),
        (0.2, 0.0, -9.0),
        (0.0, 0.0, 0.0),
    ];
    for drive in KINDS {
        let mut fleet = alone(drive);
        let limits = fleet.spec().robots[0].drive;
        let (mut before, mut sideways_mps) = (Velocity::STOP, 0.0_f64);
        for (forward, left, turn) in numbers.into_iter().cycle().take(12) {
            let command = Velocity { forward_mps: forward, left_mps: left, turn_radps: turn };
            for _ in 0..20 {
                fleet.step(&mut say(command));
                let (_, now) = now(&fleet);
                let case = format!("{drive} under {command:?}: {before:?}, {now:?}");
                let slack = 1e-3;
                assert!(now.forward_mps.abs() <= limits.max_linear_mps + slack, "{case}");
                assert!(now.turn_radps.abs() <= limits.max_angular_radps + slack, "{case}");
                assert!(now.left_mps.abs() <= 0.3 + slack, "{case}");
                let gained = |a: f64, b: f64, most: f64| (a - b).abs() <= (most + 0.01) * fleet.spec().step_s;
                let faster = limits.max_linear_acceleration_mps2;
                assert!(gained(now.forward_mps, before.forward_mps, faster), "{case}");
                assert!(gained(now.left_mps, before.left_mps, faster), "{case}");
                let turning = limits.max_angular_acceleration_radps2;
                assert!(gained(now.turn_radps, before.turn_radps, turning), "{case}");
                if drive.contains("car") {
                    let tightest_radps = limits.max_curvature_radpm() * now.forward_mps.abs();
                    assert!(now.turn_radps.abs() <= tightest_radps + slack, "{case}");
                }
                sideways_mps = sideways_mps.max(now.left_mps.abs());
                before = now;
            }
        }
        assert_eq!(fleet.contacts(), []);
        assert_eq!(sideways_mps > 0.1, drive.contains("omni"));
    }
}

#[test]
fn a_car_drives_the_circle_of_its_wheels() {
    let mut fleet = alone("kind = \"car\"\nwheelbase_m = 0.4\nmax_steer_deg = 30.0");
    let tight = Velocity { forward_mps: 0.4, left_mps: 0.0, turn_radps: 9.0 };
    fleet.run_until(2.0, &mut say(tight));
    let radius_m = 0.4 / 30.0_f64.to_radians().tan();
    let middle = now(&fleet).0 * nalgebra::Point2::new(0.0, radius_m);
    while fleet.time_s() < 20.0 {
        fleet.step(&mut say(tight));
        let off_m: f64 = (now(&fleet).0.translation.vector - middle.coords).norm() - radius_m;
        assert!(off_m.abs() < 2e-3, "{off_m}");
    }
    // This robot cannot turn in place.
    let mut fleet = alone("kind = \"car\"\nwheelbase_m = 0.4");
    fleet.run_until(2.0, &mut say(Velocity { turn_radps: 1.0, ..Velocity::STOP }));
    assert!((now(&fleet).0.rotation.angle()).abs() < 1e-9);
}

#[test]
fn an_omni_drive_goes_sideways() {
    let mut fleet = alone(KINDS[1]);
    fleet.run_until(4.0, &mut say(Velocity { left_mps: 0.3, ..Velocity::STOP }));
    let (at, _) = now(&fleet);
    assert!((at.translation.x - 3.0).abs() < 1e-4 && at.translation.y > 4.0, "{at:?}");
}

#[test]
fn lasers_look_each_at_its_rate_and_from_its_place() {
    let laser = "[[robot.laser]]\nbeams = 90\nrange_max_m = 10.0\nrate_hz = 10.0\n";
    let more = "[[robot.laser]]\nbeams = 4\nrange_max_m = 10.0\nrate_hz = 20.0\nmount_m = [0.1, 0.0]\nmount_deg = 90.0\n\
                [[robot.laser]]\nbeams = 50\nrange_max_m = 10.0\nrate_hz = 2.0\nnoise_std_m = 0.02\ndropout = 0.3\n";
    let with = |lasers: &str| {
        let text = robot("one", [3.0, 3.0], 0.0, "kind = \"driven\"");
        let (start, rest) = text.split_once("[robot.laser]").unwrap();
        let (_, end) = rest.split_once("[robot.behavior]").unwrap();
        house(&[format!("{start}{lasers}[robot.behavior]{end}")], "")
    };
    let mut fleet = Fleet::new(&with(&format!("{laser}{more}")), 7);
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); 3];
    for _ in 0..40 {
        fleet.step(&mut say(Velocity::STOP));
        for (times, reading) in times.iter_mut().zip(fleet.robots().next().unwrap().lasers()) {
            let time_s = reading.unwrap().time_s;
            if times.last() != Some(&time_s) {
                times.push(time_s);
            }
        }
    }
    assert_eq!(times.iter().map(Vec::len).collect::<Vec<_>>(), [20, 40, 4]);
    let robot = fleet.robots().next().unwrap();
    let readings: Vec<&LaserReading> = robot.lasers().flatten().collect();
    // Of four beams over a full turn, the third points straight ahead: to the left of the robot.
    let ranges_m = &readings[1].scan.ranges_m;
    assert!(((readings[1].pose * readings[1].mount).translation.x - 3.1).abs() < 1e-6);
    let main = &readings[0].scan.ranges_m;
    assert!((main[45 + 22] - ranges_m[2]).abs() < 0.2, "{main:?} {ranges_m:?}");
    let missing = readings[2].scan.ranges_m.iter().filter(|range_m| range_m.is_nan()).count();
    assert!((5..30).contains(&missing), "{missing}");
    // The other lasers do not change the readings of the first one.
    let mut alone = Fleet::new(&with(laser), 7);
    alone.run_until(2.0, &mut say(Velocity::STOP));
    assert_eq!(alone.robots().next().unwrap().reading(), robot.reading());
}

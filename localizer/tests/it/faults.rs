use crate::robot::{PERIOD_S, Robot, furnished, localizer};
use interfaces::{LaserReading, pose};
use localizer::PoseState;
use nalgebra::{Isometry2, Point2};

/// Drives; from second 16 until second 19 the readings are faulty; drives on.
fn with_fault(mut fault: impl FnMut(&mut LaserReading, usize)) -> Robot {
    let house = furnished(360, 140);
    let mut robot = Robot::new(house.clone(), house.tour(0.0), 140);
    robot.tour_until(16.0);
    let mut number = 0;
    while robot.time_s < 19.0 {
        let pose = robot.on_tour();
        robot.step_with(pose, |reading| fault(reading, number));
        number += 1;
    }
    robot.uncertain = 0;
    robot.tour_until(36.0);
    robot
}

/// The robot works after the fault, and no wrong pose was ever certain.
fn assert_works(robot: &Robot, what: &str) {
    let after = (17.0 / PERIOD_S) as usize;
    let uncertain = robot.uncertain;
    assert!(uncertain <= after / 10, "{what}: {uncertain} of {after} scans uncertain after the fault");
    robot.assert_never_wrong(0.03, what);
    robot.assert_few_changes(15, what);
}

/// Faults of a reading.
type Fault = fn(&mut LaserReading);

#[test]
fn the_robot_works_after_every_fault() {
    let faults: [(&str, Fault); 11] = [
        ("no beam", |reading| reading.scan.ranges_m.fill(f32::NAN)),
        ("too close", |reading| reading.scan.ranges_m.fill(f32::NEG_INFINITY)),
        ("covered", |reading| reading.scan.ranges_m.fill(0.06)),
        ("no return on any beam", |reading| reading.scan.ranges_m.fill(f32::INFINITY)),
        ("no return on half of the beams", |reading| reading.scan.ranges_m[..180].fill(f32::INFINITY)),
        ("upside down", |reading| reading.scan.ranges_m.reverse()),
        ("no time", |reading| reading.time_s = f64::NAN),
        ("an odometry that is not a number", |reading| reading.pose.translation.x = f64::NAN),
        ("invalid limits", |reading| reading.scan.range_max_m = -1.0),
        ("no ranges", |reading| reading.scan.ranges_m.clear()),
        ("a clock that goes back", |reading| reading.time_s -= if reading.time_s < 17.0 { 5.0 } else { 0.0 }),
    ];
    for (what, fault) in faults {
        assert_works(&with_fault(|reading, _| fault(reading)), what);
    }
}

#[test]
fn missing_beams_are_ignored() {
    let some = with_fault(|reading, number| {
        for (beam, range_m) in reading.scan.ranges_m.iter_mut().enumerate() {
            if (beam * 7 + number).is_multiple_of(20) {
                *range_m = f32::NAN;
            }
        }
    });
    assert_works(&some, "5 % of the beams are missing");
    assert_eq!(some.errors_m.len(), 360, "5 % of missing beams are no fault");
}

#[test]
fn a_frozen_scan_is_noticed() {
    let mut frozen = None;
    let robot = with_fault(|reading, _| {
        reading.scan = frozen.get_or_insert_with(|| reading.scan.clone()).clone();
    });
    assert_works(&robot, "a frozen scan");
}

#[test]
fn an_odometry_that_stands_still_is_noticed() {
    let mut still = None;
    let robot = with_fault(|reading, _| reading.pose = *still.get_or_insert(reading.pose));
    assert_works(&robot, "an odometry that stands still");
}

#[test]
fn no_odometry_at_all() {
    let house = furnished(360, 141);
    let at = house.turned(Point2::new(3.0, 1.0));
    let mut robot = Robot::new(house, pose(at.x, at.y, 0.0), 141);
    while robot.time_s < 40.0 {
        // A circle, once it has rested.
        let angle = (0.3 * (robot.time_s - 2.0)).max(0.0);
        let at = robot.house.turned(Point2::new(3.0 + angle.sin(), 2.0 - angle.cos()));
        let pose = pose(at.x, at.y, angle);
        robot.step_with(pose, |reading| reading.pose = Isometry2::identity());
    }
    assert!(robot.uncertain <= 20, "{} scans uncertain", robot.uncertain);
    assert!(robot.error_m(0.95) < 0.02, "{}", robot.error_m(0.95));
}

#[test]
fn nothing_is_certain_before_there_is_anything_to_see() {
    let mut house = furnished(360, 142);
    let mut localizer = localizer(&house.frame, Isometry2::identity());
    let mut reading = house.reading(0.0, Isometry2::identity(), &[]);
    reading.scan.ranges_m.fill(f32::NAN);
    let map = crate::robot::mapper(house.frame);
    for scan in 0..20 {
        reading.time_s = 0.1 * f64::from(scan);
        let estimate = localizer.localize(&reading, &map).estimate;
        assert!(estimate.pose.translation.vector.iter().all(|value| value.is_finite()));
    }
    assert_ne!(localizer.localize(&reading, &map).estimate.state, PoseState::Lost);
}

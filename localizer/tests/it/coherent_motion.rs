use crate::house::{House, Thing, rectangle};
use crate::robot::{Robot, error_m};
use interfaces::pose;
use localizer::PoseState;

/// A room with shelves along three walls, which all shift by `shift_m` at `time_s`, away from the robot or toward it.
fn shelves(shift_m: f64, time_s: f64) -> House {
    let mut house = House::new(0.1, 0.0, 0.01, 360, 120);
    for (x0, y0, x1, y1) in [(0.5, 0.6, 4.2, 0.9), (0.5, 4.9, 4.2, 5.2), (0.4, 1.2, 0.8, 4.6)] {
        // All shelves move in the same direction, as if the robot had moved.
        let shelf = |by_m: f64| Thing::always(rectangle(x0 + by_m, y0 + by_m, x1 + by_m, y1 + by_m));
        house.add(Thing { until_s: time_s, ..shelf(0.0) });
        house.add(Thing { from_s: time_s, ..shelf(shift_m) });
    }
    house
}

#[test]
fn most_of_the_view_may_shift_at_once() {
    for shift_m in [0.04, -0.05, 0.06, 0.08] {
        let start = pose(2.6, 2.9, 0.3);
        let mut robot = Robot::new(shelves(shift_m, 5.0), start, 120);
        let mut off_m: f64 = 0.0;
        for step in 0..150 {
            // The robot rests, then the shelves move, then the robot drives away slowly.
            let pose = pose(2.6 + 0.01 * f64::from((step - 80).max(0)), 2.9, 0.3);
            let localized = robot.step(pose);
            off_m = off_m.max(error_m(&localized, &pose));
        }
        assert!(off_m < 0.012, "shelves moved by {shift_m} m, and the robot by {off_m} m");
        assert!(robot.uncertain <= 10, "{} scans uncertain after {shift_m} m", robot.uncertain);
        robot.assert_few_changes(50, "");
    }
}

#[test]
fn shelves_may_shift_again_and_again_while_the_robot_drives() {
    // Away and back, by another vector each time; the robot drives to and fro through the room.
    let shifts = [(0.05, 0.03), (0.0, 0.0), (-0.04, 0.06), (0.0, 0.0), (0.03, -0.06)];
    let mut house = House::new(0.1, 0.0, 0.01, 360, 122);
    for (x0, y0, x1, y1) in [(0.7, 0.6, 4.2, 0.9), (0.7, 4.9, 4.2, 5.2), (0.4, 1.4, 0.7, 4.4)] {
        let mut from_s = f64::NEG_INFINITY;
        for (number, (x, y)) in std::iter::once((0.0, 0.0)).chain(shifts).enumerate() {
            let until_s = if number < shifts.len() { 8.0 + 6.0 * number as f64 } else { f64::INFINITY };
            house.add(Thing { corners: rectangle(x0 + x, y0 + y, x1 + x, y1 + y), from_s, until_s });
            from_s = until_s;
        }
    }
    let pose_at = |step: i32| {
        let way_m = 0.05 * f64::from((step - 30).max(0));
        let turn = way_m / 0.8;
        pose(2.6 + 0.8 * libm::sin(turn), 2.9 - 0.8 * (libm::cos(turn) - 1.0), turn)
    };
    let mut robot = Robot::new(house, pose_at(0), 122);
    let mut off_m: f64 = 0.0;
    for step in 0..380 {
        let localized = robot.step(pose_at(step));
        if localized.estimate.state == PoseState::Tracking {
            off_m = off_m.max(error_m(&localized, &pose_at(step)));
        }
    }
    assert!(off_m < 0.03, "off by {off_m} m");
    assert!(robot.uncertain <= 20, "{} scans uncertain", robot.uncertain);
    robot.assert_few_changes(50, "");
    assert!(robot.changes[0] > 100, "{}", robot.changes[0]);
}

#[test]
fn a_robot_that_is_shifted_by_as_much_knows() {
    // The counterpart: nothing stays in place, so the robot was moved.
    for shift_m in [0.04, -0.06, 0.08] {
        let start = pose(2.6, 2.9, 0.3);
        let mut robot = Robot::new(shelves(0.0, 5.0), start, 121);
        let there = pose(2.6 + shift_m, 2.9 + shift_m, 0.3);
        for step in 0..80 {
            let pose = if step < 50 { start } else { there };
            if step == 50 {
                robot.odometry.carried_to(&there);
            }
            let localized = robot.step(pose);
            if step > 60 {
                assert_eq!(localized.estimate.state, PoseState::Tracking);
                assert!(error_m(&localized, &pose) < 0.01, "{shift_m}: {}", error_m(&localized, &pose));
            }
        }
    }
}

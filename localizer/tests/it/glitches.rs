use crate::robot::{Robot, error_m, furnished};
use interfaces::pose;
use localizer::PoseState;
use nalgebra::Isometry2;

/// A robot that has seen all four rooms, and the pose where it stands.
fn at_home() -> (Robot, Isometry2<f64>) {
    let house = furnished(360, 110);
    let mut robot = Robot::new(house.clone(), house.tour(0.0), 110);
    robot.tour_until(110.0);
    let pose = robot.on_tour();
    robot.step(pose);
    robot.errors_m.clear();
    robot.uncertain = 0;
    (robot, pose)
}

/// Stands for some time; the number of scans until the pose is certain and exact for good.
fn recovers(robot: &mut Robot, pose: Isometry2<f64>) -> usize {
    let mut last_bad = 0;
    for scan in 1..=60 {
        let localized = robot.step(pose);
        let is_good = localized.estimate.state == PoseState::Tracking && error_m(&localized, &pose) < 0.015;
        if !is_good {
            last_bad = scan;
        }
    }
    last_bad
}

#[test]
fn a_jump_of_the_odometry_is_no_motion() {
    let (mut robot, pose) = at_home();
    for (x, y, turn) in [(1.0, 0.0, 0.0), (0.0, 0.5, 1.0), (-0.7, 0.7, -1.05), (0.0, 0.0, 3.1)] {
        robot.odometry.jump(&interfaces::pose(x, y, turn));
        let scans = recovers(&mut robot, pose);
        assert!(scans <= 10, "{scans} scans after a jump of {x} m, {y} m, {turn} rad");
    }
    robot.assert_never_wrong(0.02, "");
}

#[test]
fn a_robot_that_was_carried_a_little_finds_itself_within_a_second() {
    let (mut robot, home) = at_home();
    for (x, y, turn) in [(0.6, 0.3, 0.5), (-0.4, 0.5, -1.0)] {
        let pose = home * pose(x, y, turn);
        robot.odometry.carried_to(&pose);
        let scans = recovers(&mut robot, pose);
        assert!(scans <= 10, "{scans} scans after a shift of {x} m, {y} m, {turn} rad");
        robot.odometry.carried_to(&home);
        recovers(&mut robot, home);
    }
    robot.assert_never_wrong(0.02, "");
}

#[test]
fn a_robot_that_was_carried_to_another_room_finds_itself_within_five_seconds() {
    let (mut robot, _) = at_home();
    let there = robot.house.turned(nalgebra::Point2::new(9.0, 9.5));
    let pose = pose(there.x, there.y, 2.5);
    robot.odometry.carried_to(&pose);
    let scans = recovers(&mut robot, pose);
    assert!(scans <= 50, "{scans} scans");
    robot.assert_never_wrong(0.02, "");
}

#[test]
fn a_robot_that_was_carried_into_unknown_ground_is_never_certain_of_a_wrong_place() {
    let house = furnished(360, 111);
    let mut robot = Robot::new(house.clone(), house.tour(0.0), 111);
    // It has seen the first room, which is as large as the others.
    robot.tour_until(6.0);
    let home = robot.on_tour();
    for (x, y) in [(9.0, 9.5), (2.5, 9.0), (9.5, 9.0)] {
        for step in 0..100 {
            let angle = 0.06 * f64::from(step);
            let at = robot.house.turned(nalgebra::Point2::new(x + angle.sin(), y - angle.cos()));
            let pose = pose(at.x, at.y, angle);
            if step == 0 {
                robot.odometry.carried_to(&pose);
            }
            robot.step(pose);
        }
        robot.odometry.carried_to(&home);
        let scans = recovers(&mut robot, home);
        assert!(scans <= 20, "{scans} scans until it knows that it is at home");
    }
    robot.assert_never_wrong(0.02, "");
    robot.assert_few_changes(15, "");
}

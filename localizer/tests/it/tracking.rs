use crate::house::House;
use crate::robot::{Robot, furnished, localizer};
use interfaces::{LaserReading, heading_rad};
use localizer::PoseState;
use nalgebra::Isometry2;
use proptest::prelude::*;

#[test]
fn a_drifting_robot_knows_where_it_is() {
    let house = furnished(360, 100);
    let start = house.tour(0.0);
    let mut robot = Robot::new(house, start, 100);
    robot.tour_until(60.0);
    let drift_m = (robot.odometry.pose.translation.vector - robot.on_tour().translation.vector).norm();
    assert!(drift_m > 0.5, "the odometry is good enough: {drift_m} m");
    let [median_m, most_m] = [0.5, 1.0].map(|share| robot.error_m(share));
    assert!(median_m < 0.004 && most_m < 0.025, "{median_m}, {most_m}");
    assert_eq!(robot.uncertain, 0);
    robot.assert_few_changes(12, "");
}

#[test]
fn the_uncertainty_covers_the_error() {
    let house = furnished(360, 102);
    let mut robot = Robot::new(house.clone(), house.tour(0.0), 102);
    let mut inside = 0;
    for _ in 0..400 {
        let true_pose = robot.on_tour();
        let estimate = robot.step(true_pose).estimate;
        let error_m = (estimate.pose.translation.vector - true_pose.translation.vector).norm();
        inside += usize::from(error_m <= 3.0 * estimate.position_std_m() + 1e-3);
    }
    assert!(inside > 360, "only {inside} of 400 errors are below three standard deviations");
}

/// A scan whose beams are measured one after the other, while the robot moves from `from` to `to`.
fn sweeping(house: &mut House, time_s: f64, from: &Isometry2<f64>, to: &Isometry2<f64>) -> LaserReading {
    let mut reading = house.reading(time_s, *to, &[]);
    let (delta, beams) = (from.inv_mul(to), reading.scan.ranges_m.len());
    for group in 0..24 {
        let share = (group as f64 + 0.5) / 24.0;
        let at = delta.translation.vector * share;
        let pose = from * interfaces::pose(at.x, at.y, heading_rad(&delta) * share);
        let part = house.reading(time_s, pose, &[]);
        let range = group * beams / 24..(group + 1) * beams / 24;
        reading.scan.ranges_m[range.clone()].copy_from_slice(&part.scan.ranges_m[range]);
    }
    reading.scan.sweep_s = 0.1;
    reading
}

#[test]
fn the_sweep_of_a_scan_is_undone() {
    let worst_m = |knows_sweep: bool| {
        let mut house = furnished(360, 103);
        let mut localizer = localizer(&house.frame, house.tour(0.0));
        let mapper = crate::robot::mapper(house.frame);
        let (mut errors_m, mut before) = (Vec::new(), house.tour(0.0));
        for step in 0..250 {
            let time_s = 0.1 * f64::from(step);
            let pose = house.tour((time_s - 2.0).max(0.0));
            let mut reading = sweeping(&mut house, time_s, &before, &pose);
            if !knows_sweep {
                reading.scan.sweep_s = 0.0;
            }
            let estimate = localizer.localize(&reading, &mapper).estimate;
            errors_m.push((estimate.pose.translation.vector - pose.translation.vector).norm());
            before = pose;
        }
        errors_m.sort_by(f64::total_cmp);
        errors_m[errors_m.len() * 95 / 100]
    };
    let (undone_m, ignored_m) = (worst_m(true), worst_m(false));
    assert!(undone_m < 0.008 && ignored_m > 1.5 * undone_m, "{undone_m}, {ignored_m}");
}

#[test]
fn a_turn_in_a_corner_shifts_little() {
    let mut robot = Robot::new(furnished(360, 104), interfaces::pose(3.0, 3.0, 0.0), 104);
    let place = robot.house.turned(nalgebra::Point2::new(0.5, 0.5));
    let mut uncertain = 0;
    for step in 0..120_u32 {
        let to_wall = f64::from(step.saturating_sub(20).min(60)) / 60.0;
        let at = nalgebra::Point2::new(3.0, 3.0).lerp(&place, to_wall);
        let turn = 0.1 * f64::from(step.saturating_sub(80));
        let pose = interfaces::pose(at.x, at.y, -2.3 - 0.2 * turn.sin());
        // The laser sees ahead only.
        let localized = robot.step_with(pose, |reading| {
            let behind = |beam: usize| reading.scan.angle_rad(beam).abs() > 1.3;
            let behind: Vec<usize> = (0..360).filter(|&beam| behind(beam)).collect();
            behind.into_iter().for_each(|beam| reading.scan.ranges_m[beam] = f32::NAN);
        });
        uncertain += usize::from(step >= 80 && localized.estimate.state != PoseState::Tracking);
    }
    // With a limit of the heading that does not know the distance of the walls, no scan is certain.
    assert!(uncertain <= 15, "{uncertain} of 40 scans");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, ..ProptestConfig::default() })]

    /// From any place of the house, in any direction, with furniture anywhere.
    #[test]
    fn a_start_anywhere_is_tracked(
        x in 1.0..5.0, y in 1.0..5.0, heading in -3.0..3.0, box_x in 7.0..10.5, box_y in 7.0..10.5, seed in 100_u64..999,
    ) {
        let mut house = furnished(180, seed);
        house.add(crate::house::Thing::always(crate::house::rectangle(box_x, box_y, box_x + 0.6, box_y + 0.9)));
        let at = house.turned(nalgebra::Point2::new(x, y));
        let mut robot = Robot::new(house, interfaces::pose(at.x, at.y, heading), seed);
        for step in 0..50 {
            let turn = heading + 0.05 * f64::from(step.max(20) - 20);
            let localized = robot.step(interfaces::pose(at.x, at.y, turn));
            prop_assert!(localized.estimate.state != PoseState::Lost);
        }
        prop_assert!(robot.errors_m.len() >= 45 && robot.error_m(1.0) < 0.02, "{}", robot.error_m(1.0));
    }
}

use crate::robot::{Robot, error_m, furnished};
use localizer::PoseState;
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
        let localized = robot.step(true_pose);
        let within_m = 3.0 * localized.estimate.position_std_m() + 1e-3;
        inside += usize::from(error_m(&localized, &true_pose) <= within_m);
    }
    assert!(inside > 360, "only {inside} of 400 errors are below three standard deviations");
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

//! Scans that are far from each other, as in many public logs.

use super::*;

/// A scan per meter, and per some tens of degrees in the corners.
const STRIDE: usize = 20;

/// In micrometers, as in a CARMEN log.
fn rounded(pose: &Isometry2<f64>) -> Isometry2<f64> {
    let round = |value: f64| (value * 1e6).round() / 1e6;
    let at = pose.translation.vector;
    interfaces::pose(round(at.x), round(at.y), round(interfaces::heading_rad(pose)))
}

#[test]
fn the_heading_of_the_frame_does_not_matter() {
    let trips = [0.0, 0.2, 0.4, 0.8].map(|heading_rad| {
        let mut corridor = ahead(Corridor::new([15.0, 11.0], Plan::Varied, 110));
        let frame = interfaces::pose(30.0, -20.0, heading_rad);
        let driven = Drive { stride: STRIDE, ..Drive::new(2.2, 110) }.along(&mut corridor);
        driven.found(finder(), |reading| reading.pose = rounded(&(frame * reading.pose)))
    });
    let errors_m = trips.each_ref().map(|trip| trip.error_m());
    assert!(errors_m.iter().all(|error_m| *error_m < 0.1), "{errors_m:?}");
    for other in &trips[1..] {
        assert_eq!(other.trajectory.loops, trips[0].trajectory.loops);
        for (a, b) in trips[0].trajectory.poses.iter().zip(&other.trajectory.poses) {
            let off_m = (a.pose.translation.vector - b.pose.translation.vector).norm();
            assert!(off_m < 0.01, "{off_m} m");
        }
    }
}

#[test]
fn a_turn_that_the_odometry_misses_is_found() {
    let mut corridor = Corridor::new([15.0, 11.0], Plan::Varied, 109);
    let driven = Drive { stride: STRIDE, missed_rad: 1.4, ..Drive::new(1.2, 109) }.along(&mut corridor);
    let error_m = driven.found(finder(), |reading| reading.pose = rounded(&reading.pose)).error_m();
    assert!(error_m < 0.1, "{error_m} m");
}

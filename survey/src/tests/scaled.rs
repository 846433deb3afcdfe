//! A log whose odometry measures distances with a scale.

use super::*;
use crate::Verdict;

/// The number of passes, and the route.
fn route(readings: &[LaserReading]) -> (u32, Route) {
    let mut passes = 0;
    let route = Route::of_passes(&SurveySettings::of(PoseMode::Localized), |mut pass| {
        passes += 1;
        readings.iter().for_each(|reading| pass.add(reading.clone()));
        Ok(pass.finish())
    });
    (passes, route.unwrap())
}

#[test]
fn the_pass_is_repeated_if_the_distances_have_a_scale() {
    // The odometry of the drive measures 2 % too much; with these poses, 6 %.
    let (mut readings, truth) = drive(2, 90.0);
    readings.iter_mut().for_each(|reading| reading.pose.translation.vector *= 1.04);
    let (passes, scaled) = route(&readings);
    assert_eq!(passes, 2);
    let scale = scaled.trajectory.distance_scale.unwrap();
    assert!((scale.scale * 1.02 * 1.04 - 1.0).abs() < 0.01, "{scale:?}");
    assert!(largest_error_m(&scaled.trajectory.poses, &truth[0], &truth) < 0.015);
    let note = scaled.scale_note().unwrap();
    let [percent, words] =
        note.strip_prefix("the odometry measures distances ").unwrap().split_once(" % ").unwrap().into();
    assert!((percent.parse::<f64>().unwrap() - 6.1).abs() < 1.0, "{note}");
    assert_eq!(words, "too long: the route was found once more with this scale");
    // By the true poses, once.
    let (passes, exact) = route(&exact(&readings, &truth));
    assert!(
        exact.trajectory.distance_scale.is_none_or(|scale| !scale.is_significant()),
        "{:?}",
        exact.trajectory.distance_scale
    );
    assert_eq!(passes, 1);
    assert_eq!(exact.scale_note(), None);
}

#[test]
fn a_scale_that_wheels_do_not_explain_is_reported_and_not_used() {
    // An odometry that counts three times as much.
    let (mut readings, _) = drive(2, 90.0);
    readings.iter_mut().for_each(|reading| reading.pose.translation.vector *= 3.0);
    let (passes, route) = route(&readings);
    assert_eq!(passes, 1);
    let note = route.scale_note().unwrap();
    assert!(note.starts_with("by its scans, the robot moves 0.33 times as far as by its odometry"), "{note}");
    assert!(route.quality.verdict() != Verdict::Good, "{:?}", route.quality);
}

//! A log whose odometry measures distances with a scale.

use super::*;

#[test]
fn the_pass_is_repeated_if_the_distances_have_a_scale() {
    // The odometry of the drive measures 2 % too much; with these poses, 6 %.
    let (mut readings, truth) = drive(2, 90.0);
    let settings = SurveySettings::of(PoseMode::Localized);
    let mut passes = 0;
    let mut route = |readings: &[LaserReading]| {
        Route::of_passes(&settings, |mut pass| {
            passes += 1;
            readings.iter().for_each(|reading| pass.add(reading.clone()));
            Ok::<_, SurveyError>(pass.finish())
        })
        .unwrap()
    };
    for reading in &mut readings {
        reading.pose.translation.vector *= 1.04;
    }
    let scaled = route(&readings);
    let scale = scaled.distance_scale.unwrap();
    assert!((scale.scale * 1.02 * 1.04 - 1.0).abs() < 0.01, "{scale:?}");
    assert!(largest_error_m(&scaled.poses, &truth[0], &truth) < 0.015);
    // By the true poses, once.
    for (reading, truth) in readings.iter_mut().zip(&truth) {
        reading.pose = *truth;
    }
    let exact = route(&readings);
    assert!(exact.distance_scale.is_none_or(|scale| !scale.is_significant()), "{:?}", exact.distance_scale);
    assert_eq!(passes, 3);
}

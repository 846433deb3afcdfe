//! A simulated robot whose laser sees four posts of the robot itself.

use super::*;
use interfaces::wrap_rad;
use std::f64::consts::FRAC_PI_4;

/// Whether a beam meets a post in a scan: the edges are met in some scans only.
fn meets_post(angle_rad: f64, number: usize) -> bool {
    let beside_rad = (wrap_rad(4.0 * (angle_rad - FRAC_PI_4)) / 4.0).abs();
    beside_rad < 0.10 + 0.01 * (number % 3) as f64
}

/// The same readings with posts 0.2 m from the laser, with an error of up to 8 mm.
fn with_posts(readings: &[LaserReading]) -> Vec<LaserReading> {
    let mut readings = readings.to_vec();
    for (number, reading) in readings.iter_mut().enumerate() {
        for beam in 0..reading.scan.ranges_m.len() {
            if meets_post(reading.scan.angle_rad(beam), number) {
                let error_m = 0.008 * ((7919 * number + 104_729 * beam) as f64).sin();
                reading.scan.ranges_m[beam] = (0.2 + error_m) as f32;
            }
        }
    }
    readings
}

/// The changes and the places of a log.
fn changes(log: &Log) -> (u64, usize) {
    let mut survey =
        surveyed(&[log], &SurveySettings::of(PoseMode::Localized), |_| ControlFlow::Continue(())).unwrap();
    assert!(learn(&mut survey, 0, log, usize::MAX));
    let mapper = survey.mapper().unwrap();
    let changes = (0..mapper.frame().len()).map(|index| u64::from(mapper.map_changes(index)));
    (changes.sum(), survey.places().len())
}

#[test]
fn posts_of_the_robot_are_no_places() {
    let (readings, _) = drive(2, 120.0);
    let folder = tempfile::tempdir().unwrap();
    let free = bag(&folder.path().join("free.mcap"), &readings);
    let posts = bag(&folder.path().join("posts.mcap"), &with_posts(&readings));
    let said = |log: &Log| {
        log.summary().notes.iter().filter(|note| note.contains("parts of the robot itself")).count()
    };
    assert_eq!((said(&free), said(&posts)), (0, 1), "{:?}", posts.summary().notes);
    for reading in posts.readings().unwrap().map(Result::unwrap) {
        assert!(reading.scan.ranges_m.iter().all(|range_m| range_m.is_nan() || *range_m > 0.3));
    }
    let (free, posts) = (changes(&free), changes(&posts));
    assert_eq!((free, posts), ((0, 0), (0, 0)));
}

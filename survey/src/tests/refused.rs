//! Logs that are refused.

use super::*;
use crate::passes::RoutePass;
use std::ops::ControlFlow;

#[test]
fn mirrored_beams_are_refused_before_the_pass_is_over() {
    for (is_mirrored, mode) in
        [(false, PoseMode::Localized), (true, PoseMode::Localized), (true, PoseMode::Odometry)]
    {
        let mut pass = FirstPass::new(&SurveySettings::of(mode)).unwrap();
        let (mut readings, _) = drive(2, 120.0);
        let refused = readings.iter_mut().enumerate().find_map(|(index, reading)| {
            if is_mirrored {
                reading.scan.ranges_m.reverse();
            }
            pass.add(reading.clone());
            pass.check().err().map(|error| (index, error))
        });
        match refused {
            None => assert!(!is_mirrored),
            Some((index, error)) => {
                assert!(is_mirrored && index < 1000, "{index}: {error}");
                assert!(error.to_string().starts_with("the beams look mirrored: in "), "{error}");
            }
        }
    }
}

/// The error of `map_log` for the log of a drive, of which `change` changes the readings.
fn refused(mut change: impl FnMut(usize, &mut LaserReading)) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    let (mut readings, _) = drive(2, 120.0);
    readings.iter_mut().enumerate().for_each(|(index, reading)| change(index, reading));
    let log = bag_from(&folder.path().join("a.mcap"), &readings, 0.0);
    let settings = SurveySettings::default();
    let mut pass = RoutePass { log: &log, settings: &settings, watch: |_| ControlFlow::Continue(()) };
    pass.route().err().map(|error| error.to_string())
}

#[test]
fn logs_whose_scans_are_not_from_one_place_are_refused() {
    // Beams in another order in every scan.
    let error = refused(|index, LaserReading { scan, .. }| {
        let beams = scan.ranges_m.len();
        scan.ranges_m = (0..beams).map(|beam| scan.ranges_m[(beam * 77 + index * index) % beams]).collect();
    });
    let error = error.unwrap();
    let says = " scans have no certain pose: neither do they fit to each other, nor to the odometry; no map";
    assert!(error.contains(says) && error.contains("units"), "{error}");
}

#[test]
fn an_odometry_of_something_else_is_refused() {
    assert_eq!(refused(|_, _| {}), None);
    // One that never moves says nothing.
    assert_eq!(refused(|_, reading| reading.pose = Isometry2::identity()), None);
    for (unit, says) in
        [(0.3, "(the scans move 0.29 times as far and turn 1.0"), (3.28, "(the scans move 3.")]
    {
        let scaled = |_, reading: &mut LaserReading| {
            reading.scan.ranges_m.iter_mut().for_each(|range_m| *range_m *= unit);
        };
        let error = refused(scaled).unwrap();
        assert!(error.contains(says), "{error}");
    }
    let exchanged = refused(|_, reading| {
        let at = &mut reading.pose.translation;
        (at.x, at.y) = (at.y, at.x);
    });
    let exchanged = exchanged.unwrap();
    assert!(exchanged.starts_with("the odometry moves otherwise than the scans: in "), "{exchanged}");
}

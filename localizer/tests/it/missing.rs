//! Scans that show nothing, in a room that looks alike from two sides.

use crate::house::{House, Thing, rectangle};
use crate::robot::{error_m, localizer, mapper};
use interfaces::{GridFrame, LaserReading, pose};
use localizer::{Localized, LocalizerSettings, LoopClosingLocalizer, PoseState};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};

/// The readings of a trip, and those without a return among them: two seconds.
const READINGS: usize = 400;
const MISSING: std::ops::Range<usize> = 150..172;

/// Where the robot is: it turns in place for two seconds, then drives in a circle.
fn at(reading: usize) -> Isometry2<f64> {
    let angle = 0.03 * reading.saturating_sub(20) as f64;
    pose(3.0 + libm::cos(angle), 2.0 + 0.8 * libm::sin(angle), angle + 1.6)
}

fn frame() -> GridFrame {
    GridFrame::covering(Point2::new(-1.0, -1.0), 8.0, 6.0, 0.05).unwrap()
}

/// The states of a trip in an empty room whose readings `spoil` changes, and the largest error of a certain pose, m. Odometry is
/// perfect.
fn trip(
    mut localize: impl FnMut(&LaserReading, &mut Mapper) -> Localized,
    mut spoil: impl FnMut(usize, &mut LaserReading),
) -> (Vec<PoseState>, f64) {
    let mut house = House::new(0.1, 0.0, 0.01, 360, 150);
    house.things = vec![Thing::always(rectangle(0.0, 0.0, 6.0, 4.0))];
    let (mut map, mut states, mut worst_m) = (mapper(frame()), Vec::new(), 0.0_f64);
    for number in 0..READINGS {
        let mut reading = house.reading(0.1 * number as f64, at(number), &[]);
        reading.pose = at(0).inv_mul(&at(number));
        spoil(number, &mut reading);
        let localized = localize(&reading, &mut map);
        match localized.estimate.state {
            PoseState::Tracking => {
                map.update(&localized.reading).unwrap();
                worst_m = worst_m.max(error_m(&localized, &at(number)));
            }
            _ => map.skip(&localized.reading),
        }
        states.push(localized.estimate.state);
    }
    (states, worst_m)
}

/// A trip of a localizer that knows nothing.
fn plain_trip(spoil: impl FnMut(usize, &mut LaserReading)) -> (Vec<PoseState>, f64) {
    let mut localizer = localizer(&frame(), at(0));
    trip(|reading, map| localizer.localize(reading, map), spoil)
}

/// Nothing comes back for two seconds, but this range.
fn missing(range_m: f32) -> impl FnMut(usize, &mut LaserReading) {
    move |number, reading| {
        if MISSING.contains(&number) {
            reading.scan.ranges_m.fill(range_m);
        }
    }
}

#[test]
fn two_seconds_without_returns_are_as_good_as_no_scans() {
    for range_m in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let (states, worst_m) = plain_trip(missing(range_m));
        for (number, state) in states.into_iter().enumerate() {
            let expected = if MISSING.contains(&number) { PoseState::Uncertain } else { PoseState::Tracking };
            assert_eq!(state, expected, "{range_m}: reading {number}");
        }
        assert!(worst_m < 0.03, "{range_m}: off by {worst_m} m");
    }
}

#[test]
fn in_a_place_that_looks_alike_from_two_sides_the_odometry_decides() {
    // For so long that the robot is lost, its laser is surrounded by something that drives along.
    let covered = 150..190;
    let (states, worst_m) = plain_trip(|number, reading| {
        if covered.contains(&number) {
            reading.scan.ranges_m.iter_mut().for_each(|range_m| *range_m *= 0.6);
        }
    });
    assert!(states[150..200].contains(&PoseState::Lost), "the robot was never lost");
    let mapped = states[200..].iter().filter(|state| **state == PoseState::Tracking).count();
    assert!(mapped >= 190, "{mapped} of 200 readings mapped after the laser was covered");
    assert!(worst_m < 0.03, "off by {worst_m} m");
}

#[test]
fn a_first_map_is_not_broken_by_scans_that_show_nothing() {
    let settings = LocalizerSettings::default();
    let mut localizer = LoopClosingLocalizer::from_nothing(&settings, &frame(), at(0)).unwrap();
    let (states, _) = trip(|reading, map| localizer.localize(reading, map).localized, missing(f32::NAN));
    assert!(!localizer.is_frozen(), "the first map no longer moves");
    let mapped = states.iter().filter(|state| **state == PoseState::Tracking).count();
    assert_eq!(mapped, READINGS - MISSING.len());
}

//! Scans that show nothing, in a room that looks alike from two sides.

use crate::robot::mapper;
use interfaces::{GridFrame, LaserReading, Scan, pose};
use localizer::{Localizer, LocalizerSettings, LoopClosingLocalizer, PoseState};
use nalgebra::{Isometry2, Point2, Vector2};

const ROOM_M: [f64; 2] = [6.0, 4.0];
/// The readings of a trip, and those without a return among them: two seconds.
const READINGS: usize = 400;
const MISSING: std::ops::Range<usize> = 150..172;

/// Where the robot is: it turns in place for two seconds, then drives in a circle.
fn at(reading: usize) -> Isometry2<f64> {
    let angle = 0.03 * reading.saturating_sub(20) as f64;
    pose(3.0 + libm::cos(angle), 2.0 + 0.8 * libm::sin(angle), angle + 1.6)
}

/// The scan of an empty room at a pose.
fn reading(number: usize) -> LaserReading {
    let pose = at(number);
    let range = |beam: usize| {
        let along = pose.rotation * interfaces::rotation((beam as f64).to_radians()) * Vector2::x();
        let to_wall = |axis: usize| {
            let wall_m = if along[axis] > 0.0 { ROOM_M[axis] } else { 0.0 };
            (wall_m - pose.translation.vector[axis]) / along[axis]
        };
        let noise_m = 0.01 * libm::sin((beam * 7919 + number * 104_729) as f64);
        (to_wall(0).min(to_wall(1)) + noise_m) as f32
    };
    LaserReading {
        time_s: 0.1 * number as f64,
        pose: at(0).inv_mul(&pose),
        scan: Scan {
            angle_min_rad: 0.0,
            angle_increment_rad: 1.0_f64.to_radians(),
            range_min_m: 0.05,
            range_max_m: 10.0,
            sweep_s: 0.0,
            ranges_m: (0..360).map(range).collect(),
        },
        ..LaserReading::default()
    }
}

fn frame() -> GridFrame {
    GridFrame::covering(Point2::new(-1.0, -1.0), 8.0, 6.0, 0.05).unwrap()
}

/// The states of a trip whose readings `spoil` changes, and the largest error of a certain pose, m. Odometry is perfect.
fn trip(mut spoil: impl FnMut(usize, &mut LaserReading)) -> (Vec<PoseState>, f64) {
    let mut localizer = Localizer::from_nothing(&LocalizerSettings::default(), &frame(), at(0)).unwrap();
    let (mut map, mut states, mut worst_m) = (mapper(frame()), Vec::new(), 0.0_f64);
    for number in 0..READINGS {
        let mut reading = reading(number);
        spoil(number, &mut reading);
        let localized = localizer.localize(&reading, &map);
        if localized.estimate.state == PoseState::Tracking {
            map.update(&localized.reading).unwrap();
            let off = localized.estimate.pose.translation.vector - at(number).translation.vector;
            worst_m = worst_m.max(off.norm());
        }
        states.push(localized.estimate.state);
    }
    (states, worst_m)
}

#[test]
fn two_seconds_without_returns_are_as_good_as_no_scans() {
    for range_m in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let (states, worst_m) = trip(|number, reading| {
            if MISSING.contains(&number) {
                reading.scan.ranges_m.fill(range_m);
            }
        });
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
    let (states, worst_m) = trip(|number, reading| {
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
    let (mut map, mut mapped) = (mapper(frame()), 0);
    for number in 0..READINGS {
        let mut reading = reading(number);
        if MISSING.contains(&number) {
            reading.scan.ranges_m.fill(f32::NAN);
        }
        let localized = localizer.localize(&reading, &mut map).localized;
        match localized.estimate.state {
            PoseState::Tracking => map.update(&localized.reading).unwrap(),
            _ => map.skip(&localized.reading),
        }
        mapped += usize::from(localized.estimate.state == PoseState::Tracking);
    }
    assert!(!localizer.is_frozen(), "the first map no longer moves");
    assert_eq!(mapped, READINGS - MISSING.len());
}

//! `sensor_msgs/LaserScan` and a scan of ours, and where it is measured on a robot in the plane.

use super::messages::{Header, LaserScan, Time};
use interfaces::{LaserReading, Scan};
use nalgebra::{Isometry2, Isometry3, UnitComplex, Vector3};
use std::f64::consts::TAU;

/// The most beams of a scan, 55 per degree: a message or a line that claims more is invalid.
pub const MAX_BEAMS: usize = 20_000;
/// No laser reaches farther, m: some simulators write ∞.
const FARTHEST_M: f64 = 300.0;
/// A scan never takes longer than this, s.
const LONGEST_SWEEP_S: f64 = 10.0;
/// A laser that is tilted by more than this does not measure a plane: the cosine of 15°.
const MIN_UPRIGHT: f64 = 0.9659;
/// The stamp of the time 0 of a run without a date, ns: the first scan begins before the time 0, and ROS has no times before its
/// own 0.
pub const FIRST_STAMP_NS: i64 = LONGEST_SWEEP_S as i64 * 1_000_000_000;

/// The scan of a message. `is_upside_down`: the laser hangs with its head down, so that its beams turn clockwise.
///
/// As in ROS, the beams are measured one after the other in the time `time_increment`, and all at once if that is 0.
///
/// # Errors
///
/// When the fields are no scan.
pub fn converted(message: LaserScan, is_upside_down: bool) -> Result<Scan, String> {
    let beams = message.ranges.len();
    if !(1..=MAX_BEAMS).contains(&beams) {
        return Err(format!("{beams} ranges; a scan has 1 to {MAX_BEAMS}"));
    }
    let side = if is_upside_down { -1.0 } else { 1.0 };
    let mut scan = Scan {
        angle_min_rad: side * f64::from(message.angle_min),
        angle_increment_rad: side * increment_rad(&message),
        range_min_m: f64::from(message.range_min),
        // NaN stays NaN, and is refused.
        range_max_m: f64::from(message.range_max).clamp(f64::NEG_INFINITY, FARTHEST_M),
        sweep_s: f64::from(message.time_increment) * (beams - 1) as f64,
        ranges_m: message.ranges,
    };
    scan.check().map_err(|error| error.to_string())?;
    if scan.sweep_s > LONGEST_SWEEP_S {
        return Err(format!("a scan of {} s", scan.sweep_s));
    }
    for range_m in &mut scan.ranges_m {
        *range_m = meaning(*range_m, message.range_min, scan.range_max_m as f32);
    }
    // The order is that of the measurement where this takes time; otherwise, it is counter-clockwise.
    if scan.angle_increment_rad < 0.0 && scan.sweep_s == 0.0 {
        scan.angle_min_rad = scan.angle_rad(beams - 1);
        scan.angle_increment_rad = -scan.angle_increment_rad;
        scan.ranges_m.reverse();
    }
    Ok(scan)
}

/// The scan of a reading as a message that is stamped with the time of its first beam, by the rounded times of its beams:
/// from them, a reader finds the time of the last beam, `end_ns`.
pub fn message(reading: &LaserReading, frame_id: String, end_ns: i64) -> LaserScan {
    let scan = &reading.scan;
    let steps = scan.ranges_m.len().saturating_sub(1);
    let time_increment = (scan.sweep_s / steps.max(1) as f64) as f32;
    let sweep_s = f64::from(time_increment) * steps as f64;
    LaserScan {
        header: Header {
            stamp: Time::from_ns(end_ns.saturating_sub((sweep_s * 1e9).round() as i64)),
            frame_id,
        },
        angle_min: scan.angle_min_rad as f32,
        angle_max: scan.angle_rad(steps) as f32,
        angle_increment: scan.angle_increment_rad as f32,
        time_increment,
        scan_time: scan.sweep_s as f32,
        range_min: scan.range_min_m as f32,
        range_max: scan.range_max_m as f32,
        ranges: scan.ranges_m.clone(),
        intensities: Vec::new(),
    }
}

/// The angle between beams. Some drivers leave it at 0, or name the one of another number of beams: then it follows from
/// the first and the last angle.
fn increment_rad(message: &LaserScan) -> f64 {
    let steps = (message.ranges.len().max(2) - 1) as f64;
    let named = f64::from(message.angle_increment);
    let is_turn = named != 0.0 && named.abs() * steps <= TAU + 1e-3;
    if is_turn { named } else { f64::from(message.angle_max - message.angle_min) / steps }
}

/// A range with the meaning of REP-117. Drivers older than that report a beam without a return as a range of at least the
/// maximum.
fn meaning(range_m: f32, min_m: f32, max_m: f32) -> f32 {
    if range_m.is_finite() && (range_m < min_m || range_m <= 0.0) {
        f32::NAN
    } else if range_m >= max_m {
        f32::INFINITY
    } else {
        range_m
    }
}

/// A pose without height, roll and pitch.
pub fn flat(pose: &Isometry3<f64>) -> Isometry2<f64> {
    let ahead = pose.rotation * Vector3::x();
    // A robot that stands on end has no heading.
    let length = (ahead.x * ahead.x + ahead.y * ahead.y).sqrt();
    let (cos, sin) = if length > 1e-9 { (ahead.x / length, ahead.y / length) } else { (1.0, 0.0) };
    let rotation = UnitComplex::from_cos_sin_unchecked(cos, sin);
    Isometry2::from_parts([pose.translation.x, pose.translation.y].into(), rotation)
}

/// How a laser is mounted: its pose, and whether it is upside down.
///
/// # Errors
///
/// When it is tilted.
pub fn mounted(pose: &Isometry3<f64>) -> Result<(Isometry2<f64>, bool), String> {
    let up = (pose.rotation * Vector3::z()).z;
    if up.abs() < MIN_UPRIGHT {
        return Err(format!("is tilted by {:.0}° and does not scan a plane", up.abs().acos().to_degrees()));
    }
    Ok((flat(pose), up < 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laser_scan(angle_min: f32, angle_increment: f32, ranges: &[f32]) -> LaserScan {
        LaserScan {
            header: Header::default(),
            angle_min,
            angle_max: angle_min + angle_increment * (ranges.len() - 1) as f32,
            angle_increment,
            scan_time: 0.1,
            range_min: 0.1,
            range_max: 10.0,
            ranges: ranges.to_vec(),
            ..LaserScan::default()
        }
    }

    #[test]
    fn ranges_out_of_the_limits_have_a_meaning() {
        let ranges = [0.05, 0.1, 10.0, 10.5, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
        let scan = converted(laser_scan(0.0, 0.1, &ranges), false).unwrap();
        let expected =
            [f32::NAN, 0.1, f32::INFINITY, f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
        assert_eq!(format!("{:?}", scan.ranges_m), format!("{expected:?}"));
        assert_eq!(scan.sweep_s, 0.0);
    }

    #[test]
    fn beams_turn_counter_clockwise_where_they_are_measured_at_once() {
        let clockwise = converted(laser_scan(0.5, -0.5, &[1.0, 2.0, 3.0]), false).unwrap();
        assert_eq!((clockwise.angle_min_rad, clockwise.angle_increment_rad), (-0.5, 0.5));
        assert_eq!(clockwise.ranges_m, [3.0, 2.0, 1.0]);
        // A laser upside down: its left is our right.
        let hanging = converted(laser_scan(0.0, 0.5, &[1.0, 2.0]), true).unwrap();
        assert_eq!((hanging.angle_min_rad, hanging.angle_increment_rad), (-0.5, 0.5));
        assert_eq!(hanging.ranges_m, [2.0, 1.0]);
        let sweeping = LaserScan { time_increment: 0.01, ..laser_scan(0.5, -0.5, &[1.0, 2.0, 3.0]) };
        let sweeping = converted(sweeping, false).unwrap();
        assert_eq!((sweeping.angle_min_rad, sweeping.angle_increment_rad), (0.5, -0.5));
        assert_eq!(sweeping.ranges_m, [1.0, 2.0, 3.0]);
        assert!((sweeping.sweep_s - 0.02).abs() < 1e-9);
    }

    #[test]
    fn a_laser_without_limits_has_some() {
        let message = LaserScan { range_max: f32::INFINITY, ..laser_scan(0.0, 0.1, &[1.0, 1e4]) };
        let scan = converted(message, false).unwrap();
        assert_eq!((scan.range_max_m, &scan.ranges_m[..]), (FARTHEST_M, &[1.0, f32::INFINITY][..]));
    }

    #[test]
    fn nonsense_is_refused() {
        let good = laser_scan(0.0, 0.1, &[1.0, 2.0]);
        let refused = |message: LaserScan| converted(message, false).unwrap_err();
        assert_eq!(
            refused(LaserScan { ranges: Vec::new(), ..good.clone() }),
            "0 ranges; a scan has 1 to 20000"
        );
        let swapped = LaserScan { range_min: 10.0, range_max: 0.1, ..good.clone() };
        assert!(refused(swapped).starts_with("range limits must hold"));
        assert_eq!(
            refused(LaserScan { range_max: f32::NAN, ..good.clone() }),
            "range limits must hold 0 <= range_min < range_max, finite: 0.10000000149011612 m, NaN m"
        );
        assert!(refused(LaserScan { angle_min: f32::NAN, ..good.clone() }).starts_with("scan angles"));
        assert!(refused(LaserScan { time_increment: -1.0, ..good.clone() }).starts_with("the duration"));
        assert_eq!(refused(LaserScan { time_increment: 20.0, ..good }), "a scan of 20 s");
    }
}

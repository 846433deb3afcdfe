//! Scans that come again, and numbers for beams without a return.

use super::builder::*;
use ros::LaserScan;

/// A robot that drives at 0.4 m/s until `until_s`; in the 4 s of the log, a scan measured at `measured_s(time_s)` comes every 0.05 s.
fn driven(until_s: f64, measured_s: impl Fn(f64) -> f64, stamp_s: impl Fn(f64) -> f64) -> crate::Log {
    let mut bag = Builder::default();
    bag.mount();
    for time_s in times(80, 0.05) {
        let at = |time_s: f64| 0.4 * time_s.min(until_s);
        bag.odometry("/odom", time_s, at(time_s), 0.0);
        let ranges = vec![9.0 - at(measured_s(time_s)) as f32, 2.0, 3.0];
        bag.scan("/scan", time_s, &LaserScan { ranges, ..scan(stamp_s(time_s), "laser") });
    }
    bag.log()
}

fn tenths(time_s: f64) -> f64 {
    ((time_s + 1e-6) * 10.0).floor() * 0.1
}

#[test]
fn a_scan_that_comes_again_with_its_time_is_left_out() {
    let bag = driven(4.0, tenths, tenths);
    assert_eq!((bag.summary().scans, bag.summary().has_times, readings(&bag).len()), (40, true, 40));
    assert!(readings(&bag).windows(2).all(|pair| (pair[1].time_s - pair[0].time_s - 0.1).abs() < 1e-6));
    insta::assert_snapshot!(notes(&bag), @"40 scans come again, with one time or after a motion: left out; publish each scan once");
}

#[test]
fn a_scan_that_comes_again_with_a_new_time_is_left_out_where_the_robot_moved() {
    let bag = driven(4.0, tenths, |time_s| time_s);
    // No other scan follows the last one.
    assert_eq!((bag.summary().scans, readings(&bag).len()), (41, 41));
    let all = readings(&bag);
    assert!(all[..40].windows(2).all(|pair| pair[0].scan.ranges_m != pair[1].scan.ranges_m));
    insta::assert_snapshot!(notes(&bag), @"39 scans come again, with one time or after a motion: left out; publish each scan once");
}

/// Equal scans of a robot that stands are looks, and those of a laser that is frozen are a fault which the localizer finds.
#[test]
fn equal_scans_of_a_robot_that_stands_or_of_a_frozen_laser_stay() {
    let stands = driven(2.0, |time_s| time_s, |time_s| time_s);
    let is_frozen = |time_s: &f64| (1.0..2.5).contains(time_s);
    let frozen = driven(4.0, |time_s| if is_frozen(&time_s) { 1.0 } else { time_s }, |time_s| time_s);
    for bag in [stands, frozen] {
        assert_eq!((readings(&bag).len(), notes(&bag).as_str()), (80, ""));
    }
}

#[test]
fn a_number_for_beams_without_a_return_means_that() {
    let mut bag = Builder::default();
    bag.mount();
    for step in 0..200_u16 {
        let time_s = f64::from(step) * 0.1;
        bag.odometry("/odom", time_s, 0.2 * time_s, 0.0);
        let range = |beam: u16| match (step + beam) % 32 {
            0..8 => 5.999,
            part => 1.0 + f32::from(part) * 0.1 + f32::from((step * 7 + beam * 5) % 97) * 0.001,
        };
        let ranges = (0..64).map(range).collect();
        bag.scan("/scan", time_s, &LaserScan { ranges, angle_increment: 0.05, ..scan(time_s, "laser") });
    }
    let bag = bag.log();
    assert_has(&notes(&bag), &["the range 5.999 m comes more than 1000 times, in all directions"]);
    for reading in readings(&bag) {
        let silent = reading.scan.ranges_m.iter().filter(|range_m| **range_m == f32::INFINITY).count();
        assert_eq!((silent, reading.scan.ranges_m.contains(&5.999)), (16, false));
    }
}

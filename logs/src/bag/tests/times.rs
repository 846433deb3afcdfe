//! Stamps of scans and of the odometry that do not advance.

use super::builder::*;
use super::reading::{assert_near, at};

/// A driving robot for 2 s whose stamps are changed, with the time at which each message was recorded.
fn with_stamps(scans: impl Fn(f64) -> f64, odometry: impl Fn(f64) -> f64) -> crate::Log {
    let mut bag = Builder::default();
    bag.mount();
    for step in 0..40 {
        let time_s = f64::from(step) * 0.05;
        bag.odometry("/odom", odometry(time_s), time_s, 0.0);
        bag.messages.last_mut().unwrap().2 = ((BEGIN_S + time_s) * 1e3).round() as u64 * 1_000_000;
        if step % 2 == 1 {
            let sweeping = ros::LaserScan { time_increment: 0.02, ..scan(scans(time_s), "laser") };
            bag.scan("/scan", time_s, &sweeping);
        }
    }
    bag.log()
}

/// A recorder gets a scan after its last beam.
#[test]
fn a_scan_that_sweeps_ends_when_it_is_recorded() {
    let bag = with_stamps(|_| 0.0, |time_s| time_s);
    insta::assert_snapshot!(notes(&bag), @"the stamps of the scans are unusable: the times of the recording count");
    for (step, reading) in (0..).zip(readings(&bag)) {
        assert_near(&at(&reading), &[0.05 + 0.1 * f64::from(step), 0.0, 0.0]);
    }
}

#[test]
fn odometry_whose_stamps_do_not_advance_has_the_times_of_the_recording() {
    // The stamps of a scan are those of its first beam.
    for stamp in [|_| 0.0, f64::floor] {
        let bag = with_stamps(|time_s| time_s - 0.04, stamp);
        assert_has(
            &notes(&bag),
            &["the stamps of the odometry are unusable: the times of the recording count"],
        );
        for (step, reading) in (0..).zip(readings(&bag)) {
            assert_near(&at(&reading), &[0.05 + 0.1 * f64::from(step), 0.0, 0.0]);
        }
    }
    // A pose of a time that comes again, with a correction or without.
    let twice = with_stamps(|time_s| time_s - 0.04, |time_s| (time_s * 10.0).floor() * 0.1);
    assert!(twice.summary().notes.is_empty(), "{:?}", twice.summary().notes);
}

#[test]
fn odometry_without_times_is_not_used_and_a_note_says_so() {
    let mut bag = Builder::default();
    bag.mount();
    for step in 0..20 {
        bag.odometry("/odom", 0.0, f64::from(step), 0.0);
    }
    for time_s in times(20, 0.1) {
        bag.laser(time_s);
    }
    let bag = bag.log();
    insta::assert_snapshot!(notes(&bag), @"neither the stamps of the odometry nor the times of its recording advance: its motions are not used");
    assert!(readings(&bag).iter().all(|reading| at(reading) == [0.0; 3]));
}

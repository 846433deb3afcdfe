mod corrected;
mod faults;
mod lasers;

use super::CarmenLog;
use crate::Log;
use crate::archive::tests::gzipped;
use crate::bytes::Bytes;
use crate::summary::{LogError, LogSummary, TopicChoice};
use interfaces::{LaserReading, heading_rad};
use proptest::prelude::*;

fn open(file: &str, bytes: &[u8]) -> Result<Log, LogError> {
    CarmenLog::open(file, Bytes::Memory(bytes.into()), &TopicChoice::default())
}

/// A log of 180 readings per scan.
fn flaser(time_s: f64, pose: &str) -> String {
    let ranges = "1.5 ".repeat(178);
    format!("FLASER 180 81.83 {ranges}0.5 {pose} {pose} {time_s} host {time_s}\n")
}

fn readings(text: &str) -> Vec<LaserReading> {
    let log = open("test.log", text.as_bytes()).unwrap();
    log.readings().unwrap().map(Result::unwrap).collect()
}

fn summary(text: &str) -> LogSummary {
    open("test.log", text.as_bytes()).unwrap().summary().clone()
}

fn notes(text: &str) -> Vec<String> {
    summary(text).notes
}

fn error(text: &str) -> String {
    open("test.log", text.as_bytes()).unwrap_err().to_string()
}

#[track_caller]
fn assert_has(text: &str, parts: &[&str]) {
    parts.iter().for_each(|part| assert!(text.contains(part), "{part}: {text}"));
}

#[test]
fn only_ranges_and_times_come_from_the_scans_and_poses_from_the_odometry() {
    let text = "# FLASER in a comment\nODOM 1 2 0 0 0 0 10 h 10\n".to_owned()
        + &flaser(10.5, "77 88 3")
        + "ODOM 2 2 0.2 0 0 0 11 h 11\n";
    let readings = readings(&text);
    assert_eq!(readings.len(), 1);
    let LaserReading { time_s, pose, scan, twist, .. } = &readings[0];
    assert_eq!(*time_s, 0.0);
    let at = [pose.translation.x, pose.translation.y, heading_rad(pose)];
    assert!((at[0] - 0.5).abs() < 1e-9 && at[1].abs() < 1e-9 && (at[2] - 0.1).abs() < 1e-9, "{at:?}");
    assert!((twist.linear_mps - 1.0).abs() < 1e-9);
    assert_eq!(scan.ranges_m.len(), 180);
    assert!(scan.ranges_m[0].is_nan() && scan.ranges_m[1] == 1.5 && scan.ranges_m[179] == 0.5);
    assert!((scan.angle_rad(90)).abs() < 1e-9, "the middle beam looks ahead");
    let log = open("test.log", text.as_bytes()).unwrap();
    assert_eq!(log.reference_poses().unwrap().unwrap()[0].unwrap().translation.x, 77.0);
}

#[test]
fn the_corrected_pose_after_a_scan_is_an_origin_and_no_motion() {
    let turned = "1.5707963267948966";
    // Without a time, or with the pose of the scan and any time.
    for (scan, time_s) in
        [("5 5 1", "0"), ("5 5 1.5707963267948966", "4e9"), ("5 5 1.5707963267948966", "-7")]
    {
        let text = "ODOM 0 0 0 0 0 0 1 h 1\nODOM 1 0 0 0 0 0 2 h 2\n".to_owned()
            + &flaser(2.0, scan)
            + &format!("ODOM 5 5 {turned} 0 0 0 {time_s} h 0\nODOM 5 7 {turned} 0 0 0 3 h 3\n")
            + &flaser(3.0, "9 9 1");
        let readings = readings(&text);
        let x = readings.iter().map(|reading| reading.pose.translation.x);
        for (found, expected) in x.zip([1.0, 3.0]) {
            assert!((found - expected).abs() < 1e-9, "{found} instead of {expected}");
        }
        assert!(readings[1].pose.translation.y.abs() < 1e-9);
    }
}

#[test]
fn a_pose_of_the_odometry_right_after_a_scan_is_a_motion() {
    // The scan has the pose of the odometry, which is written after it, at about the same time.
    let text = "ODOM 0 0 0 0 0 0 1 h 1\n".to_owned()
        + &flaser(2.0, "1 0 0")
        + "ODOM 1 0 0 0 0 0 2.1 h 2\nODOM 2 0 0 0 0 0 3 h 3\n"
        + &flaser(3.0, "2 0 0");
    assert!((readings(&text)[1].pose.translation.x - 2.0).abs() < 1e-9);
}

#[test]
fn a_stated_maximum_range_is_ignored_if_beams_measure_more() {
    let scan =
        |step: u32, far: &str| format!("FLASER 180 {} {far} 0 0 0 0 0 0 {step} h {step}\n", "2 ".repeat(179));
    let log = |far: &dyn Fn(u32) -> String| {
        let scans: String = (1..41).map(|step| scan(step, &far(step))).collect();
        "PARAM robot_front_laser_max 10 h 0\n".to_owned() + &scans
    };
    let far_m = |text: &str| readings(text)[7].scan.ranges_m[179];
    assert_eq!(far_m(&log(&|step| format!("{}", 20.0 + f64::from(step)))), 28.0);
    // A number for failures is no measurement.
    assert!(far_m(&log(&|_| "50.0".to_owned())).is_nan());
}

#[test]
fn robotlaser_lines_name_their_field_of_view() {
    let text = "ODOM 0 0 0 0 0 0 1 h 1\nODOM 1 0 0 0 0 0 2 h 2\n\
        ROBOTLASER1 0 -0.5 1.0 0.5 10 0.01 0 3 1 2 11 2 7 8 0 0 0 0 0 0 0 0 0 0 0 2 h 2\n";
    let scan = &readings(text)[0].scan;
    assert_eq!((scan.angle_min_rad, scan.angle_increment_rad, scan.range_max_m), (-0.5, 0.5, 10.0));
    assert!(scan.ranges_m[..2] == [1.0, 2.0] && scan.ranges_m[2].is_nan());
}

#[test]
fn compressed_logs_are_recognized_by_their_content() {
    let text = "ODOM 0 0 0 0 0 0 1 h 1\n".to_owned() + &flaser(1.0, "0 0 0") + &flaser(2.0, "0 0 0");
    let packed = gzipped(text.as_bytes());
    let log = open("packed", &packed).unwrap();
    assert_eq!(log.summary().scans, 2);
    let same = log.readings().unwrap().map(Result::unwrap).zip(readings(&text));
    for (unpacked, plain) in same {
        assert_eq!(format!("{unpacked:?}"), format!("{plain:?}"));
    }
    let cut = open("packed", &packed[..packed.len() / 2]).unwrap_err().to_string();
    assert!(cut.starts_with("packed: "), "{cut}");
}

#[test]
fn errors_name_the_file_and_the_line() {
    assert_eq!(error("# nothing\n"), "test.log: no line is a scan (FLASER or ROBOTLASER1): not a CARMEN log");
    assert_eq!(error("\nFLASER 3 1 2\n"), "test.log:2: FLASER ends before its last reading");
    insta::assert_snapshot!(error("FLASER x 1 2\n"), @"test.log:1: FLASER: `x` is no valid value for the number of readings");
    insta::assert_snapshot!(error("ODOM 1 nan 0 0 0 0 1 h 1\n"), @"test.log:1: ODOM: `nan` is no valid value for x, y and theta");
    let missing = CarmenLog::open("no/such.log", Bytes::File("no/such.log".into()), &TopicChoice::default())
        .unwrap_err()
        .to_string();
    assert!(missing.starts_with("no/such.log: "), "{missing}");
}

#[test]
fn a_last_line_that_is_cut_off_is_left_out() {
    let text = flaser(1.0, "0 0 0") + "FLASER 180 1.5 1.5";
    assert_eq!(summary(&text).scans, 1);
    insta::assert_snapshot!(notes(&text).join("\n"), @"
    line 2, the last one, is cut off and left out
    no ODOM line: the odometry stands still
    ");
}

#[test]
fn scans_wait_for_the_odometry_after_them() {
    // Two scans before the next pose, and one whose time lies before the last pose.
    let text = "ODOM 0 0 0 0 0 0 1 h 1\n".to_owned()
        + &flaser(1.2, "0 0 0")
        + &flaser(1.4, "0 0 0")
        + "ODOM 1 0 0 0 0 0 2 h 2\nODOM 2 0 0 0 0 0 3 h 3\n"
        + &flaser(2.5, "0 0 0")
        + &flaser(2.9, "0 0 0")
        + &flaser(3.5, "0 0 0");
    let x: Vec<f64> = readings(&text).iter().map(|reading| reading.pose.translation.x).collect();
    for (found, expected) in x.iter().zip([0.2, 0.4, 1.5, 1.9, 2.0]) {
        assert!((found - expected).abs() < 1e-9, "{x:?}");
    }
    assert_eq!(x.len(), 5);
}

/// Words of logs, and words that are none.
fn word() -> impl Strategy<Value = String> {
    prop_oneof![
        Just("FLASER".to_owned()),
        Just("ODOM".to_owned()),
        Just("ROBOTLASER1".to_owned()),
        Just("PARAM robot_frontlaser_offset".to_owned()),
        Just("\n".to_owned()),
        (0..4_u8).prop_map(|count| count.to_string()),
        any::<f64>().prop_map(|number| number.to_string()),
        any::<f32>().prop_map(|number| number.to_string()),
        "[\\PC]{0,4}",
    ]
}

fn read_all(bytes: &[u8]) {
    let Ok(log) = open("any", bytes) else { return };
    let readings: Vec<_> = log.readings().unwrap().map(Result::unwrap).collect();
    assert_eq!(readings.len(), log.summary().scans);
    assert!(readings.windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
    assert!(readings.iter().all(|reading| reading.scan.check().is_ok()));
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        read_all(&bytes);
    }

    #[test]
    fn any_words_are_read_or_refused(words in proptest::collection::vec(word(), 0..80)) {
        read_all(words.join(" ").as_bytes());
    }

    #[test]
    fn any_times_are_read(times in proptest::collection::vec((any::<f64>(), any::<f64>()), 1..20)) {
        let lines = times.iter().map(|(scan_s, odom_s)| {
            format!("ODOM 1 2 3 0 0 0 {odom_s} h 0\nFLASER 2 1 2 0 0 0 0 0 0 {scan_s} h 0\n")
        });
        read_all(lines.collect::<String>().as_bytes());
    }

    #[test]
    fn compressed_nonsense_is_refused(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let mut packed = vec![0x1f, 0x8b, 8, 0];
        packed.extend(bytes);
        read_all(&packed);
    }
}

#[test]
fn a_robot_stands_if_neither_odometry_nor_scans_move() {
    let log = |step_m: f64, range_step_m: f64| {
        let line = |index: u32| {
            let (time_s, x) = (f64::from(index), step_m * f64::from(index));
            let ranges = format!("{} ", 2.0 + range_step_m * f64::from(index)).repeat(180);
            format!(
                "ODOM {x} 0 0 0 0 0 {time_s} h {time_s}\nFLASER 180 {ranges}0 0 0 0 0 0 {time_s} h {time_s}\n"
            )
        };
        (1..20).map(line).collect::<String>()
    };
    let stands = |text: &str| summary(text).stands;
    assert!(stands(&log(0.0, 0.0)) && stands(&log(1e-4, 0.0)));
    assert!(!stands(&log(0.1, 0.0)) && !stands(&log(0.0, 0.1)));
    let poses = readings(&log(1e-4, 0.0));
    assert!(poses.iter().all(|reading| reading.pose == nalgebra::Isometry2::identity()));
}

#[test]
fn a_compressed_log_grows_by_a_hundred_at_most() {
    let text = flaser(1.0, "0 0 0") + &"#\n".repeat(90 << 19);
    let error = open("a.log.gz", &gzipped(text.as_bytes())).unwrap_err().to_string();
    assert!(error.starts_with("a.log.gz: the "), "{error}");
    assert_has(&error, &["unpack to more than", "unpack it first: gzip -d FILE"]);
}

/// 40 scans of a robot that drives ahead in a room, with a range of this factor; `odometry` writes its lines.
fn room(factor: f64, odometry: impl Fn(f64) -> String) -> String {
    let line = |step: u32| {
        let time_s = 100.0 + f64::from(step);
        let ranges: String =
            (0..180).map(|beam| format!("{:.3} ", factor * (2.0 + f64::from(beam % 60) * 0.02))).collect();
        odometry(time_s) + &format!("FLASER 180 {ranges}0 0 0 0 0 0 {time_s} host {time_s}\n")
    };
    (0..40).map(line).collect()
}

fn impossible(text: &str) -> Option<String> {
    summary(text).impossible
}

#[test]
fn times_in_milliseconds_are_named() {
    let line = |step: u32| {
        let (x, at) = (0.03 * f64::from(step), 100.0 * f64::from(step + 1));
        format!("ODOM {x} 0 0 0 0 0 {at} host {at}\n") + &flaser(at, &format!("{x} 0 0"))
    };
    let why = impossible(&(0..300).map(line).collect::<String>()).unwrap();
    assert!(why.starts_with("the times look like milliseconds: in "), "{why}");
}

#[test]
fn speeds_that_do_not_fit_poses_and_times_are_named() {
    // A robot that drives at 0.4 m/s, with rests, and 3 % of slip; its times, lengths and speeds by these factors.
    let log = |times: f64, lengths: f64, speeds: f64| {
        let mut x = 0.0;
        let mut line = |step: u32| {
            let (time_s, mps) = (100.0 + 0.1 * f64::from(step), if step % 100 < 70 { 0.4 } else { 0.0 });
            x += mps * 0.1 * if step.is_multiple_of(7) { 0.8 } else { 1.0 };
            let (at, x, tv) = (time_s * times, x * lengths, mps * speeds);
            format!("ODOM {x} 0 0 {tv} 0 0 {at} host {at}\n") + &flaser(at, &format!("{x} 0 0"))
        };
        (0..400).map(&mut line).collect::<String>()
    };
    for good in [log(1.0, 1.0, 1.0), log(1.0, 1.0, -1.0), log(1.2, 1.0, 1.0), log(2.0, 1.0, 0.0)] {
        assert_eq!(impossible(&good), None);
    }
    // Speeds in mm/s are another unit.
    assert_eq!(impossible(&log(1.0, 1.0, 1000.0)), None);
    for (wrong, factor) in
        [(log(2.0, 1.0, 1.0), "2."), (log(0.5, 1.0, 1.0), "0.5"), (log(1.0, 0.5, 1.0), "2.")]
    {
        let why = impossible(&wrong).unwrap();
        assert!(why.starts_with(&format!("the speeds of the odometry are {factor}")), "{why}");
    }
}

#[test]
fn a_recording_at_another_pace_is_noted() {
    let log = |pace: f64| {
        let line = |step: u32| {
            let recorded_s = f64::from(step);
            let scan = flaser(pace * recorded_s, "0 0 0");
            let own = scan.find("host ").unwrap();
            format!("{}host {recorded_s}\n", &scan[..own])
        };
        (1..60).map(line).collect::<String>()
    };
    let [same, said] = [1.0, 2.0].map(|pace| notes(&log(pace)).join("; "));
    assert!(!same.contains("recording"), "{same}");
    assert_has(&said, &["took 116 s by their own times, which count, and 58 s by those of the recording"]);
}

#[test]
fn logs_that_cannot_be_true_are_named() {
    let right = |time_s: f64| format!("ODOM {} 0 0 0 0 0 {time_s} host {time_s}\n", (time_s * 0.3).sin());
    assert_eq!(impossible(&room(1.0, right)), None);
    insta::assert_snapshot!(impossible(&room(1000.0, right)).unwrap(), @"the ranges look like millimeters: in 40 of 40 scans, their median is beyond 100 m (the first: 2580, which would be 2.58 m); ranges are in meters: divide them by 1000");
    for (factor, unit) in [(100.0, "centimeters"), (0.001, "kilometers")] {
        assert_has(
            &impossible(&room(factor, right)).unwrap(),
            &["the ranges look like ", unit, ": in 40 of"],
        );
    }
    let swapped =
        |time_s: f64| format!("ODOM {time_s} 0 0 0 0 0 {} host {time_s}\n", 5.0 + (time_s * 0.3).sin());
    let why = impossible(&room(1.0, swapped)).unwrap();
    assert!(why.starts_with("x and the time look exchanged in the ODOM lines: in "), "{why}");
    assert!(why.contains(" of 39, the time goes back, while in 39 x is within 10 s"), "{why}");
    // A robot that drives ahead at 1 m/s has an x like a time, but its times are right.
    let ahead = |time_s: f64| format!("ODOM {time_s} 0 0 0 0 0 {time_s} host {time_s}\n");
    assert_eq!(impossible(&room(1.0, ahead)), None);
    // Many lasers write one number where nothing comes back.
    let open =
        room(1.0, right).replace("2.0", "655.35 2.0").replace("FLASER 180", "FLASER 180 655.35 655.35");
    let open = open.lines().map(|line| match line.split_once("FLASER 180 ") {
        Some((_, rest)) => format!("FLASER {} {rest}\n", rest.split(' ').count() - 9),
        None => format!("{line}\n"),
    });
    assert_eq!(impossible(&open.collect::<String>()), None);
    insta::assert_snapshot!(impossible(&room(0.0, right)).unwrap(), @"none of 40 scans has a range between the limits of the laser: nothing is seen");
    insta::assert_snapshot!(impossible(&flaser(1.0, "0 0 0")).unwrap(), @"one scan: what changes is found by comparing scans, at least 2");
}

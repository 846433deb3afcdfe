//! Lines that are left out, holes of the odometry, and clocks that are set.

use super::*;

/// Poses and scans of a robot that drives ahead at 0.5 m/s, each line by its time after 1.7e9 s.
fn drive(line: impl Fn(f64) -> String) -> String {
    (0..400).map(|step| line(0.1 * f64::from(step))).collect()
}

fn odom(time_s: f64) -> String {
    odom_at(time_s, time_s)
}

/// The pose at a time, by a clock that shows another one.
fn odom_at(time_s: f64, clock_s: f64) -> String {
    let (x, at) = (0.5 * time_s, 1.7e9 + clock_s);
    format!("ODOM {x} 0 0 0 0 0 {at} h {time_s}\n")
}

fn scan(time_s: f64) -> String {
    flaser(1.7e9 + time_s, "0 0 0")
}

#[test]
fn invalid_lines_are_left_out() {
    let good: Vec<String> = (0..40).map(|step| odom(f64::from(step)) + &scan(f64::from(step))).collect();
    let long = format!("FLASER {}\n", "9".repeat(500));
    let with =
        |lines: &[&str]| good.concat() + &lines.concat() + &good[39].replace(" 1700000039", " 1700000040");
    let number = "is no valid value for the number of readings";
    for (bad, what) in [
        ("ODOM nan 0 0 0 0 0 1700000039 h 0\n", "ODOM: `nan` is no valid value for x, y and theta"),
        ("FLASER 0\n", &format!("FLASER: `0` {number}")),
        ("FLASER 3 1 2\n", "FLASER ends before its last reading"),
        ("FLASER 180 1.5\0 1.5\n", "FLASER: `1.5\0` is no valid value for a range"),
        ("ROBOTLASER1 0 -1 1\n", "ROBOTLASER1 ends before resolution"),
        (&long, &format!("FLASER: `{}…` {number}", "9".repeat(40))),
    ] {
        let kind = if bad.starts_with("ODOM") { "ODOM line" } else { "scan" };
        assert_eq!(notes(&with(&[bad])), [format!("1 {kind} is invalid and left out, line 81: {what}")]);
        let all = readings(&with(&[bad]));
        assert_eq!(all.len(), 41);
        assert_eq!(format!("{all:?}"), format!("{:?}", readings(&with(&[]))));
        // The error of the first one, if there are more than valid ones.
        assert_eq!(error(&with(&[bad; 42])), format!("test.log:81: {}", interfaces::printable(what)));
    }
    let several = with(&["FLASER 0\n", "FLASER 0\n", "ODOM 1\n", "ODOM\n"]);
    insta::assert_snapshot!(notes(&several).join("\n"), @"
    2 scans are invalid and left out, the first in line 81: FLASER: `0` is no valid value for the number of readings
    2 ODOM lines are invalid and left out, the first in line 83: ODOM ends before x, y and theta
    ");
}

#[test]
fn a_scan_with_an_invalid_pose_is_used() {
    let text = drive(|time_s| {
        odom(time_s) + &flaser(1.7e9 + time_s, if time_s > 20.0 { "0 nan 0" } else { "0 0 0" })
    });
    let log = open("test.log", text.as_bytes()).unwrap();
    assert_eq!((log.summary().scans, log.summary().notes.len()), (400, 0));
    let references = log.reference_poses().unwrap().unwrap();
    assert!(references[0].is_some() && references[399].is_none());
}

#[test]
fn holes_and_restarts_of_the_odometry_are_noted() {
    let hole = "the odometry is missing for more than 2 s while there are scans, in 1 place: the way there is that of the scans alone";
    for missing in [0.0..10.0, 10.0..20.0, 30.0..50.0] {
        let text = drive(|time_s| {
            scan(time_s) + &if missing.contains(&time_s) { String::new() } else { odom(time_s) }
        });
        assert_eq!(notes(&text), [hole], "{missing:?}");
    }
    let restarted = drive(|time_s| {
        let at = odom(time_s);
        scan(time_s) + &if time_s > 20.0 { at.replacen("ODOM ", "ODOM -1", 1) } else { at }
    });
    let [note] = &notes(&restarted)[..] else { panic!("{:?}", notes(&restarted)) };
    assert_has(note, &["the odometry jumps faster than any robot moves, once (the first time by "]);
    let ends = readings(&restarted).last().unwrap().pose.translation.x;
    // It goes back from there.
    assert!((ends - 0.1).abs() < 0.1, "{ends}");
    // A pause of the recording: the robot drives on, and a scan is the first line after it.
    let paused = drive(|time_s| {
        if (10.0..20.0).contains(&time_s) { String::new() } else { scan(time_s) + &odom(time_s + 0.05) }
    });
    assert_eq!(notes(&paused), [""; 0]);
    let ends = readings(&paused).last().unwrap().pose.translation.x;
    assert!((ends - 19.9).abs() < 0.1, "{ends}");
}

#[test]
fn a_log_whose_clock_is_set_has_the_date_of_its_longest_part() {
    // The robot starts with an old clock, which is set after 3 s.
    let set = |time_s: f64| if time_s < 3.0 { time_s - 1e8 } else { time_s };
    let summary = summary(&drive(|time_s| odom_at(time_s, set(time_s)) + &scan(set(time_s))));
    let begin_s = summary.begin_s.unwrap();
    assert!((begin_s - 1.7e9).abs() < 1e-3, "{begin_s}");
    insta::assert_snapshot!(summary.notes.join("\n"), @"
    a jump of the clock counts as 0.100 s
    the date and the hours are those of the longest part between jumps of the clock (36.9 s of 39.9 s)
    ");
}

/// A scan whose first reading was measured at a time.
fn measured(measured_s: f64, time_s: f64) -> String {
    scan(time_s).replacen("1.5", &format!("{:.3}", 30.0 - 0.5 * measured_s), 1)
}

#[test]
fn scans_that_come_again_are_left_out() {
    let same_time = drive(|time_s| odom(time_s) + &measured(time_s, time_s).repeat(2));
    let new_time = drive(|time_s| odom(time_s) + &measured((time_s / 0.2 + 0.1).floor() * 0.2, time_s));
    for (text, scans) in [(same_time, 400), (new_time, 201)] {
        let log = open("test.log", text.as_bytes()).unwrap();
        assert_eq!((log.summary().scans, log.summary().has_times), (scans, true));
        assert_eq!([readings(&text).len(), log.reference_poses().unwrap().unwrap().len()], [scans; 2]);
        assert_has(&notes(&text).join(" "), &["scans come again, with one time or after a motion"]);
    }
    // A robot that stands.
    let stands = drive(|time_s| odom_at(time_s.min(20.0), time_s) + &measured(time_s.min(20.0), time_s));
    assert_eq!((readings(&stands).len(), notes(&stands)), (400, Vec::<String>::new()));
}

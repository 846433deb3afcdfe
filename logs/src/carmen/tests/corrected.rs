use super::*;
use std::fmt::Write as _;

/// A log of a robot that drives 1 m/s by its odometry, with the poses of FLASER lines at these times.
fn drive(scan_pose: impl Fn(f64) -> String) -> String {
    (0..40).fold("PARAM robot_frontlaser_offset 0.2\n".to_owned(), |mut text, step| {
        let time_s = 0.2 * f64::from(step);
        let _ = writeln!(text, "ODOM {time_s} 0 0 0 0 0 {} h 0", 1e9 + time_s);
        text + &flaser(1e9 + time_s, &scan_pose(time_s))
    })
}

fn open_corrected(text: &str) -> Result<Log, LogError> {
    let choice = TopicChoice { is_corrected: true, ..TopicChoice::default() };
    CarmenLog::open("test.log", Bytes::Memory(text.as_bytes().into()), &choice)
}

fn refused(text: &str) -> String {
    open_corrected(text).unwrap_err().to_string()
}

#[test]
fn poses_of_scans_are_used_on_request_only() {
    let turned = drive(|time_s| format!("3 {} 1.5707963267948966", 1.1 * time_s));
    let log = open_corrected(&turned).unwrap();
    for (step, reading) in log.readings().unwrap().map(Result::unwrap).enumerate() {
        // The laser is 0.2 m in front of the robot, which looks along y.
        let expected = [3.0, 0.22 * step as f64 - 0.2];
        let at = reading.pose.translation;
        assert!((at.x - expected[0]).abs() < 1e-9 && (at.y - expected[1]).abs() < 1e-9, "{at} at {step}");
        assert!((heading_rad(&reading.pose) - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!(reading.mount.translation.x, 0.2);
    }
    let summary = log.summary();
    assert_eq!(summary.notes, ["the poses are those of the FLASER lines, which another SLAM has corrected"]);
    // Without the request, nothing of them is used.
    let others = drive(|time_s| format!("{time_s} 7 1"));
    assert_eq!(readings(&turned).len(), 40);
    for (one, other) in readings(&turned).iter().zip(readings(&others)) {
        assert_eq!((&one.pose, &one.twist, &one.mount), (&other.pose, &other.twist, &other.mount));
    }
}

#[test]
fn logs_without_corrected_poses_are_refused() {
    let of_odometry = drive(|time_s| format!("{} 5 0", time_s + 0.25));
    insta::assert_snapshot!(refused(&of_odometry), @"test.log: no corrected poses: those of the FLASER lines are those of the odometry (within 0.1 m and 0.05 rad), which --pose odometry uses; without --pose corrected, the poses are found from the scans");
    let mut still = drive(|_| "0 0 0".to_owned());
    // The ranges change, so that the robot moves even if its odometry did not.
    still = still.replace("0.5 0 0 0", "0.5 1 2 0");
    assert_has(
        &refused(&still),
        &["test.log: no corrected poses: those of the FLASER lines are all the same (1, 2); "],
    );
    let other = "ROBOTLASER1 0 -0.5 1.0 0.5 10 0.01 0 3 1 2 11 2 7 8 0 0 0 0 0 0 0 0 0 0 0 2 h 2\n";
    let says = "no corrected poses: 2 of 2 scans are ROBOTLASER1 lines, or have an invalid pose; those of FLASER lines would";
    assert_has(&refused(&other.repeat(2)), &[says]);
}

#[test]
fn what_is_whole_of_a_compressed_log_that_is_cut_off_is_read() {
    let scan =
        |step: u32| flaser(1e9 + f64::from(step), &format!("{} 0 0", f64::from(step * 7919 % 1000) * 1e-3));
    let text: String = (0..400).map(scan).collect();
    let packed = gzipped(text.as_bytes());
    let half = &packed[..packed.len() / 2];
    let log = open("test.log.gz", half).unwrap();
    let scans = log.summary().scans;
    assert!((100..300).contains(&scans), "{scans}");
    let found: Vec<LaserReading> = log.readings().unwrap().map(Result::unwrap).collect();
    let times = |readings: &[LaserReading]| readings.iter().map(|reading| reading.time_s).collect::<Vec<_>>();
    assert!(times(&found) == times(&readings(&text)[..scans]));
    let [cut, line, _, ..] = &log.summary().notes[..] else { panic!("{:?}", log.summary().notes) };
    let (bytes, lines, last_s) = (half.len(), scans + 1, scans as f64 - 1.0);
    assert_has(
        cut,
        &[&format!("the gzip file is cut off after {bytes} bytes, and the rest is missing: {lines} lines (")],
    );
    assert_has(cut, &[&format!(" bytes of text) could be read, up to {last_s:.1} s after the first scan")]);
    assert_eq!(*line, format!("line {lines}, the last one, is cut off and left out"));
    assert_eq!(log.content_hash().unwrap(), log.content_hash().unwrap());
    insta::assert_snapshot!(open("test.log.gz", &packed[..12]).unwrap_err().to_string(), @"test.log.gz: the gzip file is cut off after 12 bytes, and the 0 bytes of text that could be unpacked have no whole scan (FLASER or ROBOTLASER1)");
}

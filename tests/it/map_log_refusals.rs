//! `map_log`: logs and arguments that are refused.

use crate::map_log::standing_log;
use crate::map_log_state::moving_log;
use crate::run::Run;
use std::fs;

/// The log of a laser that stands, with other ranges.
fn scaled_log(factor: f64) -> String {
    let scaled = |line: &str| match line.strip_prefix("FLASER 180 ") {
        None => format!("{line}\n"),
        Some(rest) => {
            let words = rest.split(' ').enumerate().map(|(index, word)| match word.parse::<f64>() {
                Ok(range_m) if index < 180 => (range_m * factor).to_string(),
                _ => word.to_owned(),
            });
            format!("FLASER 180 {}\n", words.collect::<Vec<_>>().join(" "))
        }
    };
    standing_log(1.7e9, 40).lines().map(scaled).collect()
}

#[test]
fn logs_that_cannot_be_true_are_refused_before_anything_is_written() {
    let run = Run::of("map_log");
    run.write("a.log", &scaled_log(1000.0));
    let message = run.refuses("a.log");
    let says = "error: a.log: the ranges look like millimeters: in 40 of 40 scans";
    assert!(message.contains(says), "{message}");
    run.write("a.log", &moving_log(120).repeat(2));
    insta::assert_snapshot!(run.refuses("a.log"), @"
    note: a.log: 120 scans are not later than the scan before and count as 0.001 s later
    error: a.log: 119 of 240 scans are in the log twice, after the same scan as the first time: they would count twice; leave them out
    ");
    run.write("a.log", &scaled_log(1.0));
    run.goes_well("a.log --quiet --no-rrd");
}

#[test]
fn a_file_has_one_purpose() {
    let run = Run::of("map_log");
    run.write("a.log", &standing_log(1.7e9, 40));
    run.write("thesis.tex", "of the user");
    insta::assert_snapshot!(run.refuses("a.log --no-rrd --mcap thesis.tex"), @"error: cannot write the bag of --mcap: cannot write thesis.tex: the results would replace it, and no run wrote it; move it, or choose another name");
    insta::assert_snapshot!(run.refuses("a.log --no-rrd --mcap b --state ./b"), @"error: --mcap and --state name the same file ./b: give each its own");
    insta::assert_snapshot!(run.refuses("a.log --no-rrd --state out"), @"error: --out and --state name the same file out: give each its own");
    let run = run.with("four_rooms");
    insta::assert_snapshot!(run.refuses("--duration 1 --rrd b.gif --gif b.gif"), @"error: --rrd and --gif name the same file b.gif: give each its own");
    assert_eq!(fs::read_to_string(run.path("thesis.tex")).unwrap(), "of the user");
}

#[cfg(unix)]
#[test]
fn pipes_are_no_logs_and_no_lists_of_results() {
    let run = Run::of("map_log");
    let pipe = |name: &str| nix::unistd::mkfifo(&run.path(name), nix::sys::stat::Mode::S_IRWXU).unwrap();
    pipe("pipe");
    insta::assert_snapshot!(run.refuses("pipe"), @"error: pipe: it is not a regular file (but a folder, a pipe or a device)");
    fs::create_dir(run.path("bag")).unwrap();
    pipe("bag/metadata.yaml");
    insta::assert_snapshot!(run.refuses("bag"), @"error: bag/metadata.yaml: it is not a regular file (but a folder, a pipe or a device)");
    run.write("a.log", &standing_log(1.7e9, 40));
    fs::create_dir(run.path("out")).unwrap();
    pipe("out/.curious_run.json");
    insta::assert_snapshot!(run.refuses("a.log"), @"error: cannot write out/.curious_run.json: it is not a regular file; move the folder, or give another one by --out");
}

/// Names of files need not be text.
#[cfg(target_os = "linux")]
#[test]
fn names_that_are_no_text() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let run = Run::of("map_log");
    for name in [&b"a\xff.log"[..], b"a b\n.log"] {
        let name = OsStr::from_bytes(name);
        fs::write(run.path("").join(name), standing_log(1.7e9, 40)).unwrap();
        let ended = run.command("--no-rrd --state s").arg(name).output().unwrap();
        assert_eq!(ended.status.code(), Some(0), "{ended:?}");
        fs::remove_file(run.path("s")).unwrap();
    }
    assert_eq!(run.summary().at("/logs"), &serde_json::json!(["a b\\n.log"]));
}

/// Poses of another SLAM, where there are none.
#[test]
fn corrected_poses_must_be_there() {
    let run = Run::of("map_log");
    run.write("a.log", &moving_log(120));
    insta::assert_snapshot!(run.refuses("a.log --pose corrected"), @"error: a.log: no corrected poses: those of the FLASER lines are those of the odometry (within 0.1 m and 0.05 rad), which --pose odometry uses; without --pose corrected, the poses are found from the scans");
    insta::assert_snapshot!(run.refuses("a.log --map-frame map"), @"error: --map-frame names the map of another SLAM, whose poses are used with --pose corrected alone: add that, or leave it out");
    run.write("a.log", &standing_log(1.7e9, 40));
    insta::assert_snapshot!(run.refuses("a.log --pose corrected --map-frame map"), @"
    note: a.log: the poses are those of the FLASER lines, which another SLAM has corrected
    error: --map-frame is for bags, but a.log is a CARMEN log, which has no topics and frames: leave it out
    ");
}

/// The resolution that the error names is enough.
#[test]
fn a_place_that_is_too_large_names_ways_out() {
    let run = Run::of("map_log");
    run.write("a.log", &scaled_log(10.0));
    let message = run.refuses("a.log --resolution 0.01 --map-memory 0.02");
    let says =
        ["the place is too large for a map: about ", "more than 0.020 GiB", "--max-range", "--map-memory"];
    assert!(says.iter().all(|says| message.contains(says)), "{message}");
    let (_, enough) = message.split_once("--resolution, at least ").unwrap();
    let (enough, _) = enough.split_once(')').unwrap();
    run.goes_well(&format!("a.log --no-rrd --map-memory 0.02 --resolution {enough}"));
}

#[test]
fn what_is_no_log_is_refused_and_nothing_is_written() {
    let run = Run::of("map_log");
    let refused = |name: &str, text: &[u8]| {
        fs::write(run.path(name), text).unwrap();
        run.refuses(name)
    };
    insta::assert_snapshot!(run.refuses("gone.log"), @"error: gone.log: No such file or directory (os error 2)");
    insta::assert_snapshot!(refused("a.log", b"hello\n"), @"error: a.log: no line is a scan (FLASER or ROBOTLASER1): not a CARMEN log");
    insta::assert_snapshot!(refused("a.bag", b"#ROSBAG V2.0\n"), @"error: a.bag: a bag of ROS 1; convert it with `rosbags-convert --src FILE.bag --dst FOLDER` (from PyPI: pip install rosbags)");
    insta::assert_snapshot!(refused("a.mcap", b"\x89MCAP0\r\n"), @"error: a.mcap: no message: the bag is empty; a.mcap has no end, since it is cut off or its recorder was stopped: what is whole before byte 8 of 8 was read");
}

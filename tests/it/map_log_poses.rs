//! `map_log`: the poses of another SLAM, and logs that are cut off.

use crate::map_log::with_bag;
use crate::map_log_state::moving_log;
use crate::run::Run;
use nalgebra::{Isometry2, Point2};
use std::fmt::Write;
use std::fs;

/// The positions of a trajectory.
fn positions(run: &Run) -> Vec<Point2<f64>> {
    let text = fs::read_to_string(run.out("trajectory.tum")).unwrap();
    let point = |line: &str| {
        let words: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        Point2::new(words[1], words[2])
    };
    text.lines().map(point).collect()
}

/// The largest distance between positions after the motion that brings the first ones and the last ones together.
fn farthest_m(one: &[Point2<f64>], other: &[Point2<f64>]) -> f64 {
    let far = (0..one.len()).max_by(|a, b| {
        let from_begin_m = |at: &usize| (one[*at] - one[0]).norm();
        from_begin_m(a).total_cmp(&from_begin_m(b))
    });
    let far = far.unwrap();
    let turn_rad = nalgebra::Vector2::angle(&(one[far] - one[0]), &(other[far] - other[0]));
    let by = |turn_rad: f64| {
        let turn = nalgebra::Rotation2::new(turn_rad);
        let distance_m = |(a, b): (&Point2<f64>, &Point2<f64>)| (turn * (a - one[0]) - (b - other[0])).norm();
        one.iter().zip(other).map(distance_m).fold(0.0, f64::max)
    };
    by(turn_rad).min(by(-turn_rad))
}

/// A run in a simulated house writes tf as a SLAM does: `map` to `odom`, which corrects a bad odometry, and `odom` to the robot.
#[test]
fn a_bag_is_mapped_along_the_poses_of_another_slam() {
    let run = with_bag();
    run.goes_well("a.mcap --quiet --no-rrd");
    let (found, localized) = (positions(&run), run.summary());
    let ended = run.goes_well("a.mcap --pose corrected --no-rrd --state s.state");
    ended.prints(&["m, corrected by another SLAM, 0 places recognized, "]);
    let summary = run.summary();
    assert_eq!((summary.text("/verdict"), summary.text("/settings/pose")), ("good", "corrected"));
    let note = summary.text("/notes/0");
    ended.says(&["the poses are those of another SLAM: ", " corrections, ", note]);
    let corrected = positions(&run);
    let left_out = found.len() - corrected.len();
    assert!(left_out < 10 && farthest_m(&found[left_out..], &corrected) < 0.15);
    let seen_m2 = [&localized, &summary].map(|summary| summary.number("/seen_m2"));
    assert!((seen_m2[1] / seen_m2[0] - 1.0).abs() < 0.1, "{seen_m2:?}");
    // A later run knows it from the state.
    run.goes_well("a.mcap --no-rrd --state s.state").says(&["a.mcap is learned already"]);
    // Not without a map.
    let refused = run.refuses("a.mcap --pose corrected --map-frame slam --no-rrd --out other");
    assert!(refused.contains("a.mcap: no transform (tf) has the frame `slam`"), "{refused}");
}

/// In FLASER lines, the poses are turned by 0.5 rad.
#[test]
fn a_carmen_log_is_mapped_along_its_corrected_poses() {
    let run = Run::of("map_log");
    let turn = Isometry2::rotation(0.5);
    let (mut pose, mut text) = (String::new(), String::new());
    for line in moving_log(120).lines() {
        let words: Vec<&str> = line.split(' ').collect();
        if words[0] == "ODOM" {
            let [x, y, heading]: [f64; 3] = [1, 2, 3].map(|word| words[word].parse().unwrap());
            // The odometry is 10 % too short.
            let at = turn * Point2::new(x / 0.9, y / 0.9);
            pose = format!("{} {} {}", at.x, at.y, heading + 0.5);
            writeln!(text, "{line}").unwrap();
        } else {
            let last = words.len() - 3;
            let ranges = words[..last - 6].join(" ");
            writeln!(text, "{ranges} {pose} {pose} {}", words[last..].join(" ")).unwrap();
        }
    }
    run.write("a.log", &text);
    let ended = run.goes_well("a.log --pose corrected --no-rrd --accept-map");
    ended.says(&["note: a.log: the poses are those of the FLASER lines, which another SLAM has corrected"]);
    let first = positions(&run)[0];
    let flaser = text.lines().find(|line| line.starts_with("FLASER")).unwrap();
    let words: Vec<&str> = flaser.split(' ').collect();
    let expected = [words.len() - 9, words.len() - 8].map(|word| words[word].parse().unwrap());
    assert!((first - Point2::from(expected)).norm() < 1e-6, "{first} {expected:?}");
}

#[test]
fn what_is_whole_of_a_bag_that_is_cut_off_is_mapped_and_said() {
    let run = with_bag();
    let bytes = fs::read(run.path("a.mcap")).unwrap();
    fs::write(run.path("cut.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    let ended = run.goes_well("cut.mcap --no-rrd");
    let summary = run.summary();
    assert!((150.0..850.0).contains(&summary.number("/scans")), "{}", summary.number("/scans"));
    let notes = [summary.text("/notes/0"), summary.text("/notes/1")];
    ended.says(&["cut.mcap has no end, since it is cut off or its recorder was stopped: "]);
    ended.says(&["what could be read ends "]);
    ended.says(&notes);
    let page = fs::read_to_string(run.out("report.html")).unwrap();
    assert!(notes.iter().all(|note| page.contains(note)), "{page}");
}

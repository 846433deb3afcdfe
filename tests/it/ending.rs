//! A run that is ended from outside: in order by Ctrl-C, out of order by a kill.
#![cfg(unix)]

use crate::recording::Recording;
use crate::run::{Ended, Run};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

/// Runs at this many times real time, so that it is under way for long enough.
const SPEED: f64 = 20.0;

fn starts(run: &Run) -> Child {
    run.starts(&format!("--duration 1h --speed {SPEED}"))
}

pub(crate) fn signal(child: &Child, signal: &str) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// Waits until a recording has begun.
fn wait_for_recording(run: &Run) {
    let start = Instant::now();
    while std::fs::metadata(run.out("four_rooms.rrd")).map_or(0, |file| file.len()) < 50_000 {
        assert!(start.elapsed() < Duration::from_secs(60), "no recording");
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn ctrl_c_ends_a_run_in_order() {
    let run = Run::new();
    let child = starts(&run);
    wait_for_recording(&run);
    signal(&child, "-INT");
    let ended = Ended::from(child.wait_with_output().unwrap());
    assert_eq!(ended.code, Some(130), "{ended:?}");

    let summary = run.summary();
    assert_eq!(summary.text("/ended_by"), "interrupted");
    let simulated_s = summary.number("/simulated_s");
    assert!(simulated_s > 0.0 && simulated_s < 3600.0, "{simulated_s}");
    // A paced run is not faster than its pace.
    assert!(
        summary.number("/real_time_factor") < 1.05 * SPEED + 1.0,
        "{}",
        summary.number("/real_time_factor")
    );
    assert!((Recording::read(&run.out("four_rooms.rrd")).end_s() - simulated_s).abs() < 1e-6);
    assert_eq!(crate::run::names(&run.path("out")).len(), 11);
}

#[test]
fn a_killed_run_leaves_all_but_the_last_seconds() {
    const LOST_S: f64 = 5.0;
    let run = Run::new();
    let mut child = starts(&run);
    wait_for_recording(&run);
    let start = Instant::now();
    std::thread::sleep(Duration::from_secs_f64(LOST_S + 2.0));
    let recorded_s = SPEED * (start.elapsed().as_secs_f64() - LOST_S);
    signal(&child, "-KILL");
    assert_eq!(child.wait().unwrap().code(), None);

    let recording = Recording::read(&run.out("four_rooms.rrd"));
    assert!(recording.end_s() > recorded_s, "{} of at least {recorded_s} s", recording.end_s());
    assert!(recording.curve("/curves/scores/coverage").len() as f64 > 0.9 * recorded_s);
    assert_eq!(crate::run::names(&run.path("out")), ["four_rooms.rrd"], "half-written files");
}

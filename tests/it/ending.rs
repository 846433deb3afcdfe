//! A run that is ended from outside: normally by Ctrl-C, abnormally by a kill.
#![cfg(unix)]

use crate::recording::Recording;
use crate::run::{Ended, Run, wait_until};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::io::{BufRead, BufReader};
use std::process::Child;
use std::time::Duration;

/// The speed of the runs, times real time: low enough that a run lasts long enough for the test.
const SPEED: f64 = 20.0;

fn starts(run: &Run) -> Child {
    run.starts(&format!("--duration 1h --speed {SPEED}"))
}

/// Sends a signal to the program.
pub(crate) fn send(signal: Signal, child: &Child) {
    kill(Pid::from_raw(child.id() as i32), signal).unwrap();
}

/// Ctrl-C; the request to terminate of `docker stop` and systemd; a closed terminal.
#[test]
fn signals_end_a_run_in_order() {
    [Signal::SIGINT, Signal::SIGTERM, Signal::SIGHUP].into_iter().for_each(ends_in_order);
}

/// Even a run so slow that it is asleep nearly all the time ends soon.
#[test]
fn ctrl_c_ends_a_slow_run() {
    let run = Run::new();
    let child = run.starts("--duration 1h --speed 0.001");
    wait_until(|| run.unfinished("four_rooms.rrd").exists());
    send(Signal::SIGINT, &child);
    let ended = Ended::of(child);
    assert_eq!(ended.code, Some(130), "{ended:?}");
    assert!(run.summary().number("/simulated_s") < 0.5);
}

fn ends_in_order(signal: Signal) {
    let run = Run::new();
    let child = starts(&run);
    let recording = run.unfinished("four_rooms.rrd");
    wait_until(|| std::fs::metadata(&recording).is_ok_and(|file| file.len() >= 50_000));
    send(signal, &child);
    let ended = Ended::of(child);
    assert_eq!(ended.code, Some(130), "{ended:?}");
    assert!(ended.stdout.starts_with("agent in four rooms, interrupted: "), "{ended:?}");

    let summary = run.summary();
    assert_eq!(summary.text("/ended_by"), "interrupted");
    let simulated_s = summary.number("/simulated_s");
    assert!(simulated_s > 0.0 && simulated_s < 3600.0, "{simulated_s}");
    // A run with a set speed must not be faster.
    let factor = summary.number("/real_time_factor");
    assert!(factor < 1.05 * SPEED + 1.0, "{factor}");
    assert!((Recording::read(&run.out("four_rooms.rrd")).end_s() - simulated_s).abs() < 1e-6);
    assert_eq!(crate::run::names(&run.path("out")).len(), 15);
}

#[test]
fn a_killed_run_leaves_all_but_the_last_seconds() {
    const LOST: Duration = Duration::from_secs(5);
    let run = Run::new();
    let mut child = starts(&run);
    // Lines of progress begin with the simulated time.
    let lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut times_s = lines.map(|line| line.unwrap().split(' ').next().unwrap().parse::<f64>().unwrap());
    let simulated_s = times_s.find(|time_s| *time_s > 40.0).unwrap();
    std::thread::sleep(LOST);
    send(Signal::SIGKILL, &child);
    assert_eq!(child.wait().unwrap().code(), None);

    let recording = Recording::read(&run.unfinished("four_rooms.rrd"));
    assert!(recording.end_s() >= simulated_s, "{} of at least {simulated_s} s", recording.end_s());
    assert!(recording.curve("/curves/scores/coverage").len() as f64 > 0.9 * simulated_s);
    assert_eq!(crate::run::names(&run.path("out")), ["unfinished_run"]);

    // The next run keeps it.
    run.goes_well("--quiet --no-rrd --duration 1");
    assert!(!run.path("out/unfinished_run").exists());
    assert_eq!(crate::run::names(&run.path("out/unfinished_run_1")).len(), 3);
    assert_eq!(crate::run::names(&run.path("out")).len(), 15);
}

//! Ctrl-C keeps the finished trials.
#![cfg(unix)]

use super::{report, rows};
use crate::ending::send;
use crate::run::{Ended, Run, wait_until};
use nix::sys::signal::Signal;
use std::collections::BTreeSet;

#[test]
fn ctrl_c_keeps_the_finished_trials() {
    let run = Run::of("grid_world");
    let trials = "--trials 100000 --steps 2000 --strategy recency --strategy random --estimator paper";
    // The first line of progress: by then there are finished trials.
    let ended = run.interrupted(trials, |_| true);
    assert_eq!(ended.code, Some(130), "{ended:?}");
    let line = ended.stderr.lines().next().unwrap();
    assert!(line.contains(" of 200000 trials, ") && line.ends_with(" left"), "{line:?}");

    let reported: usize = line.split(' ').next().unwrap().parse().unwrap();
    let report = report(&run);
    assert_eq!(report["interrupted"], true);
    let rows = rows(&run);
    let finished: BTreeSet<_> = rows.iter().map(|row| (row.strategy.clone(), row.seed)).collect();
    let count = finished.len();
    assert!((reported..200_000).contains(&count), "{count} finished, {reported} reported");
    assert_eq!(rows.len(), 80 * finished.len(), "only whole trials are kept");
    let counted: u64 = ["recency", "random"]
        .map(|name| report["runs"][0]["strategies"][name]["trials"].as_u64().unwrap())
        .iter()
        .sum();
    assert_eq!(counted, finished.len() as u64);
    assert!(run.out("figure3.svg").exists());
    ended.prints(&["Interrupted: ", "written to out"]);
}

#[test]
fn nothing_is_written_before_the_first_trial_is_finished() {
    let run = Run::of("grid_world");
    let child = run.starts("--trials 1 --steps 100000000 --estimator paper");
    wait_until(|| run.out("unfinished_run").exists());
    send(Signal::SIGTERM, &child);
    let ended = Ended::of(child);
    assert_eq!(ended.code, Some(130), "{ended:?}");
    insta::assert_snapshot!(ended.stderr, @"interrupted before the first trial was finished: no report");
    assert_eq!(run.names(), [""; 0]);
}

//! Ctrl-C keeps the finished trials.
#![cfg(unix)]

use super::{report, rows};
use crate::ending::{send, wait_for_recording};
use crate::recording::Recording;
use crate::run::{Ended, Run};
use nix::sys::signal::Signal;
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader};

#[test]
fn ctrl_c_keeps_the_finished_trials() {
    let run = Run::grid();
    let mut child =
        run.starts("--trials 100000 --steps 2000 --strategy recency --strategy random --estimator paper");
    // The first line of progress: by then there are finished trials.
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    stderr.read_line(&mut line).unwrap();
    assert!(line.contains(" of 200000 trials, ") && line.ends_with(" left\n"), "{line:?}");
    send(Signal::SIGINT, &child);
    let ended = Ended::from(child.wait_with_output().unwrap());
    assert_eq!(ended.code, Some(130), "{ended:?}");

    let reported: usize = line.split(' ').next().unwrap().parse().unwrap();
    let report = report(&run);
    assert_eq!(report["interrupted"], true);
    let rows = rows(&run);
    let finished: BTreeSet<_> = rows.iter().map(|row| (row.strategy.clone(), row.seed)).collect();
    assert!(
        (reported..200_000).contains(&finished.len()),
        "{} finished, {reported} reported",
        finished.len()
    );
    assert_eq!(rows.len(), 80 * finished.len(), "only whole trials are kept");
    let counted: u64 = ["recency", "random"]
        .map(|name| report["runs"][0]["strategies"][name]["trials"].as_u64().unwrap())
        .iter()
        .sum();
    assert_eq!(counted, finished.len() as u64);
    assert!(run.out("figure3.svg").exists());
    assert!(ended.stdout.starts_with("Interrupted: "), "{}", ended.stdout);
    assert!(ended.stdout.contains("written to out"), "{}", ended.stdout);
}

#[test]
fn a_signal_closes_the_recording_even_before_the_first_trial_is_finished() {
    let run = Run::grid();
    let child = run.starts("--trials 1 --steps 100000000 --rrd trial.rrd --estimator paper");
    wait_for_recording(&run.path("trial.unfinished.rrd"));
    send(Signal::SIGTERM, &child);
    let ended = Ended::from(child.wait_with_output().unwrap());
    assert_eq!(ended.code, Some(130), "{ended:?}");
    insta::assert_snapshot!(ended.stderr, @"interrupted before the first trial was finished: no report");
    assert_eq!(run.names(), ["trial.rrd"]);

    // It does not matter whether the program ended by itself first.
    let recording = Recording::read(&run.path("trial.rrd"));
    let last = *recording.times("/", "step").last().unwrap();
    assert!((1..=20_000).contains(&last), "{last}");
    assert_eq!(recording.curve_over_steps("/curves/scores/coverage").last().unwrap().0, last);
}

//! Ctrl-C keeps the finished trials.
#![cfg(unix)]

use super::{report, rows};
use crate::ending::send;
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
fn nothing_is_written_before_the_first_trial_is_finished() {
    let run = Run::grid();
    let child = run.starts("--trials 1 --steps 100000000 --estimator paper");
    let has_begun = (0..1200).any(|_| {
        std::thread::sleep(std::time::Duration::from_millis(50));
        run.out("unfinished_run").exists()
    });
    assert!(has_begun);
    send(Signal::SIGTERM, &child);
    let ended = Ended::from(child.wait_with_output().unwrap());
    assert_eq!(ended.code, Some(130), "{ended:?}");
    insta::assert_snapshot!(ended.stderr, @"interrupted before the first trial was finished: no report");
    assert_eq!(run.names(), [""; 0]);
}

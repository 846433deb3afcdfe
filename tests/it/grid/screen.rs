//! The output of the program on standard output and standard error.

use crate::run::Run;

#[test]
fn quiet_is_silent() {
    let ended = Run::grid().goes_well("--quiet --steps 200 --trials 1");
    assert_eq!((ended.stdout.as_str(), ended.stderr.as_str()), ("", ""));
}

#[test]
fn the_table_names_every_strategy_and_fits_a_terminal() {
    let ended = Run::grid().goes_well("--steps 500");
    assert_eq!(ended.stderr, "");
    for strategy in ["curious", "recency", "poisson", "random", "coin"] {
        assert!(ended.stdout.lines().any(|line| line.starts_with(strategy)), "{strategy}: {}", ended.stdout);
    }
    let table = ended.stdout.lines().filter(|line| !line.starts_with("written to "));
    assert!(table.clone().all(|line| line.chars().count() <= 100), "{}", ended.stdout);
    assert!(table.clone().count() > 10);
}

#[test]
fn worlds_are_listed() {
    insta::assert_snapshot!(Run::grid().goes_well("--list-worlds").stdout, @"
    two_blocks           The paper's grid world: a slow block in the upper right, a fast block along the bottom wall.
    open_hall            A hall with pillars; four blocks, far from each other, that move at four different rates.
    corridor_with_doors  Rooms along a corridor; six sliding doors that open and close at different rates.
    many_slow_blocks     Twelve slow blocks in nine rooms; each moves once in 20 to 60 steps.
    one_fast_block       One block that moves at every step, and eight that stay for hundreds of steps.
    ");
}

#[test]
#[cfg(target_os = "linux")]
fn a_terminal_shows_a_bar_that_goes_away() {
    let run = Run::grid();
    let ended = crate::terminal::run(&run, "--steps 20000 --trials 2 --estimator paper", |_| ());
    assert_eq!(ended.code, Some(0), "{ended:?}");
    let (before, after) = ended.stdout.split_once("two blocks\r\n").unwrap();
    assert!(before.contains(" of 10 trials"), "{before:?}");
    assert!(!after.contains(" of 10 trials"), "{after:?}");
}

/// Like `| head`.
#[test]
fn a_run_goes_on_when_nobody_listens() {
    let run = Run::grid();
    let mut child = run.starts("--steps 500");
    drop((child.stdout.take(), child.stderr.take()));
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert_eq!(super::report(&run)["interrupted"], false);
}

//! The output of the program on standard output and standard error.

use crate::run::Run;

#[test]
fn the_table_names_every_strategy_and_fits_a_terminal() {
    let ended = Run::of("grid_world").goes_well("--steps 500");
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
    insta::assert_snapshot!(Run::of("grid_world").goes_well("--list-worlds").stdout, @"
    two_blocks           The paper's grid world: a slow block in the upper right, a fast block along the bottom wall.
    open_hall            A hall with pillars; four blocks, far from each other, that move at four different rates.
    corridor_with_doors  Rooms along a corridor; six sliding doors that open and close at different rates.
    many_slow_blocks     Twelve slow blocks in nine rooms; each moves once in 20 to 60 steps.
    one_fast_block       One block that moves at every step, and eight that stay for hundreds of steps.
    ");
}

//! The output of a run with default options, but fewer steps: files and a table.

use crate::run::{Run, names};

#[test]
fn the_output_folder_is_complete() {
    let run = Run::of("grid_world");
    let ended = run.goes_well("--steps 300");
    assert_eq!(run.names(), ["out"]);
    assert_eq!(ended.stderr, "");
    for strategy in ["curious", "recency", "poisson", "random", "coin"] {
        assert!(ended.stdout.lines().any(|line| line.starts_with(strategy)), "{strategy}: {}", ended.stdout);
    }
    let mut table = ended.stdout.lines().filter(|line| !line.starts_with("written to "));
    assert!(table.all(|line| line.chars().count() <= 100), "{}", ended.stdout);
    let written = names(&run.path("out"));
    assert_eq!(written.len(), 6, "{written:?}");
    // With the figure of the second estimator.
    let listed = "written to out: report.json, figure3-two_blocks-two-state-gaps.png, \
                  figure3-two_blocks-two-state-gaps.svg, figure3.png, figure3.svg, trials.csv";
    assert_eq!(ended.stdout.lines().last(), Some(listed));

    let picture = image::open(run.out("figure3.png")).unwrap().into_rgb8();
    assert!(picture.width() >= 800 && picture.height() >= 400, "{:?}", picture.dimensions());
    let colors: std::collections::BTreeSet<_> = picture.pixels().map(|pixel| pixel.0).collect();
    assert!(colors.len() > 10, "{} colors", colors.len());
    let drawing = std::fs::read_to_string(run.out("figure3.svg")).unwrap();
    assert!(drawing.contains("<svg") && drawing.trim_end().ends_with("</svg>"));
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

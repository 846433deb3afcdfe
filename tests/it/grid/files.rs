//! The output files of a run with default options, but fewer steps.

use crate::run::{Run, names};

#[test]
fn the_output_folder_is_complete() {
    let run = Run::of("grid_world");
    let ended = run.goes_well("--steps 300");
    assert_eq!(run.names(), ["out"]);
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

//! The output files of a run with default options, but fewer steps.

use crate::run::{Run, names};

#[test]
fn the_output_folder_is_complete() {
    let run = Run::grid();
    let ended = run.goes_well("--steps 300");
    assert_eq!(run.names(), ["out"]);
    let written = names(&run.path("out"));
    for file in ["figure3.png", "figure3.svg", "report.json", "trials.csv"] {
        assert!(written.iter().any(|name| name == file), "{file} is not in {written:?}");
    }
    // In addition the figure of the second estimator.
    assert_eq!(written.len(), 6, "{written:?}");
    let last = ended.stdout.lines().last().unwrap();
    let listed = "written to out: report.json, figure3-two-blocks-two-state-gaps.png, \
                  figure3-two-blocks-two-state-gaps.svg, figure3.png, figure3.svg, trials.csv";
    assert_eq!(last, listed);

    let picture = image::open(run.out("figure3.png")).unwrap().into_rgb8();
    assert!(picture.width() >= 800 && picture.height() >= 400, "{:?}", picture.dimensions());
    let colors: std::collections::BTreeSet<_> = picture.pixels().map(|pixel| pixel.0).collect();
    assert!(colors.len() > 10, "{} colors", colors.len());
    let drawing = std::fs::read_to_string(run.out("figure3.svg")).unwrap();
    assert!(drawing.contains("<svg") && drawing.trim_end().ends_with("</svg>"));
}

#[test]
fn the_table_of_trials_has_every_trial_at_every_sample() {
    let run =
        super::ran("--steps 300 --trials 2 --seed 4 --strategy recency --strategy random --estimator paper");
    let rows = super::rows(&run);
    let trials: std::collections::BTreeSet<_> =
        rows.iter().map(|row| (row.strategy.clone(), row.seed)).collect();
    let expected = [("random", 4), ("random", 5), ("recency", 4), ("recency", 5)];
    assert_eq!(trials, expected.map(|(name, seed)| (name.to_owned(), seed)).into());
    assert!(rows.iter().all(|row| row.world == "two blocks" && row.estimator == "paper"));
    for trial in rows.chunk_by(|a, b| (&a.strategy, a.seed) == (&b.strategy, b.seed)) {
        assert_eq!(trial.len(), 80);
        assert_eq!(trial[79].step, 300);
        assert!(trial.windows(2).all(|pair| pair[0].step < pair[1].step));
        // No block event has happened in the first step, and many have at the end.
        assert!(trial[0].rate_error.is_none() && trial[0].log_error.is_none(), "{:?}", trial[0]);
        assert!(trial[79].rate_error.is_some() && trial[79].log_error.is_some(), "{:?}", trial[79]);
        assert!(trial.iter().all(|row| (0.0..=1.0).contains(&row.coverage)), "{trial:?}");
    }
}

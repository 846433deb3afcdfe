//! The table for a terminal.

use super::*;

/// A report of 10 seeds in which log errors and map qualities are given, with a little noise.
fn made([curious, recency, poisson]: [f64; 3], [of_curious, of_recency]: [f64; 2], chance: f64) -> Report {
    let (settings, mut trials) = experiment(1, &["paper"], &["curious", "recency", "poisson"], 10);
    let mut stream = ChaCha8Rng::seed_from_u64(5);
    for trial in &mut trials {
        let (error, quality) = match trial.strategy.as_str() {
            "curious" => (curious, of_curious),
            "recency" => (recency, of_recency),
            _ => (poisson, 0.8),
        };
        let own = chance * normal(&mut stream);
        for sample in &mut trial.samples {
            (sample.log_error, sample.map_quality) = (error + own, quality + 0.01 * own);
        }
    }
    Report::new(settings, trials)
}

#[test]
fn an_interrupted_experiment_says_so_first() {
    let (mut settings, mut trials) = experiment(1, &["paper"], &["curious", "recency"], 3);
    settings.interrupted = true;
    trials.truncate(4);
    let table = Report::new(settings, trials).table();
    assert!(table.starts_with("Interrupted: 4 of 6 trials were finished.\n\ntwo_blocks\n"), "{table}");
}

#[test]
fn the_winner_of_an_interrupted_experiment_is_that_of_the_pairs() {
    // Recency has the smaller error in both trials of both, but also the trial with the largest error.
    let (mut settings, mut trials) = experiment(1, &["paper"], &["curious", "recency"], 3);
    settings.interrupted = true;
    trials.retain_mut(|trial| {
        let errors = if trial.strategy == "curious" { &[0.4, 0.5][..] } else { &[0.3, 0.41, 2.0] };
        let (error, samples) = (errors.get(trial.seed as usize), trial.samples.iter_mut());
        error.map(|error| samples.for_each(|sample| sample.log_error = *error)).is_some()
    });
    let report = Report::new(settings, trials);
    let table = report.table();
    let sentence = "recency learns rates fastest: its log error over the run is 0.79 times\n\
                    that of curious,\nin the 2 trials of both (significant: ";
    assert!(table.contains(sentence), "{table}");
    // No star: the means are those of different trials.
    let numbers = table.split_once("How to read it").unwrap().0;
    assert!(!numbers.contains('*'), "{table}");
    let of_pairs = report.runs[0].comparison("recency", "curious", Measure::PRIMARY).unwrap();
    let error = |name| report.runs[0].strategy(name).unwrap().value(Measure::PRIMARY);
    assert!(error("recency") > error("curious") && of_pairs.ratio < 1.0);
}

#[test]
fn a_strategy_is_the_fastest_only_if_that_is_significant() {
    let table = made([0.5, 0.51, 0.9], [0.98; 2], 0.1).table().replace('\n', " ");
    assert!(table.contains("recency has the smallest log error over the run, 0.94 times"), "{table}");
    assert!(table.contains("that of curious; the difference is not significant (p = "), "{table}");
    assert!(!table.contains("learns rates fastest"), "{table}");
}

#[test]
fn the_table_names_the_winner() {
    insta::assert_snapshot!(report(1, &["two-state"], &["curious", "recency", "full-observation"], 5).table(), @"
    two_blocks
    5 trials of 20,000 steps, estimator two-state, sensor radius 4

                        log error       rate error        map correct      time at
    strategy           final    area   final    area  all cells  changing  changes
    curious           0.326   0.476*  0.453*  0.497*    0.9848    0.8857*  10.0 %
    recency           0.321*  0.542   0.463   0.547     0.9879*   0.8806    7.0 %
    full-observation  0.241   0.296   0.349   0.305     0.9892    0.9075   20.0 %

    Paired differences over seeds, curious minus the other: mean ± half of its
    95 % interval, p-value of the t test
                      log error, area      log error, final      map correct, final
    recency      -0.066 ±0.028  0.003  +0.006 ±0.053  0.780  -0.0030 ±0.0078  0.345
    full-        +0.180 ±0.048 <0.001  +0.085 ±0.050  0.009  -0.0044 ±0.0062  0.125
    observation

    curious learns rates fastest: its log error over the run is 0.88 times
    that of recency (significant: p = 0.003 after Holm's correction).

    How to read it: errors are 0 and map correct is 1 at best; final is the value at
    the end, area the mean over the run, * the best; time at changes is the share of
    steps with a changing cell in view.
    ");
}

#[test]
fn the_table_fits_a_terminal() {
    let all = ["curious", "recency", "poisson", "random", "coin", "information-gain", "full-observation"];
    for (worlds, estimators, seeds) in
        [(1, ["paper"].as_slice(), 1), (3, &["paper", "two-state"], 4), (9, &["paper"], 2)]
    {
        let report = report(worlds, estimators, &all, seeds);
        let table = report.table();
        assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
        let shown = report.runs.iter().filter(|run| table.contains(&format!("{}\n", run.world))).count();
        assert_eq!(shown, if worlds > 8 { 1 } else { report.runs.len() });
        assert_eq!(report.leaves_out_worlds(), worlds > 8);
        assert!(!table.contains("report.json"), "a program without files prints it too: {table}");
    }
}

#[test]
fn a_reference_cannot_win_and_false_changes_are_reported() {
    let (settings, mut trials) = experiment(1, &["paper"], &["recency", "full-observation"], 3);
    trials[0].false_change_events = 7;
    trials[0].false_map_changes = 9;
    let table = Report::new(settings, trials).table();
    assert!(!table.contains("learns rates fastest"), "{table}");
    assert!(table.contains("False change events on cells that never change: recency 7.\n"), "{table}");
    let of_map = "False changes of the map on these cells, with corrections: recency 9.\n";
    assert!(table.contains(of_map), "{table}");
    let line = table.lines().find(|line| line.starts_with("full-observation")).unwrap();
    assert!(!line.contains('*'), "{line}");
}

#[test]
fn no_trial_is_a_sentence() {
    let report = Report::new(ReportSettings::default(), Vec::new());
    assert_eq!(report.table(), "No trial was finished.\n");
    assert_eq!(written(&report).len(), 1, "no figure");
}

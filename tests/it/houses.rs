//! Trials in physics worlds, and their report.

use crate::grid::{report, results, same};
use crate::run::{Run, names};

/// Two houses and two strategies for a simulated minute.
const SHORT: &str = "--generate 2 --seed 3 --duration 1m --strategy curious --strategy random";

/// A finished run without output on the screen.
fn ran(arguments: &str) -> Run {
    let run = Run::of("house_trials");
    let ended = run.goes_well(&format!("--quiet {arguments}"));
    assert_eq!((ended.stdout.as_str(), ended.stderr.as_str()), ("", ""));
    run
}

#[test]
fn the_report_has_every_key_and_every_trial() {
    let run = Run::of("house_trials");
    let ended = run.goes_well(&format!("{SHORT} --strategy full-observation"));
    ended.prints(&["all worlds (2)\n2 trials of 1 simulated minute", "curious ", "AUC"]);
    ended.prints(&["Paired differences over worlds"]);
    let table = ended.stdout.lines().filter(|line| !line.starts_with("written to "));
    assert!(table.clone().all(|line| line.chars().count() <= 80), "{}", ended.stdout);

    let report = report(&run);
    let keys =
        ["schema", "build", "version", "arguments", "duration_s", "trials", "interrupted", "runs", "files"];
    assert_eq!(report.as_object().unwrap().len(), keys.len());
    assert!(keys.iter().all(|key| report.get(key).is_some()), "{report}");
    assert_eq!([&report["duration_s"], &report["trials"]], [60, 1]);
    let worlds: Vec<_> = report["runs"].as_array().unwrap().iter().map(|run| run["world"].as_str()).collect();
    assert_eq!(worlds, [Some("house-3"), Some("house-4"), Some("all worlds (2)")]);
    for result in results(&run) {
        let number =
            |key: &str| result.entry[key].as_f64().unwrap_or_else(|| panic!("{key}: {}", result.entry));
        assert!(number("collisions") >= 0.0 && number("false_change_events") >= 0.0);
        // Nothing may have changed within a minute.
        let auc = result.entry["final_rate_auc"].as_f64();
        assert!(auc.is_none_or(|auc| (0.0..=1.0).contains(&auc)) && result.entry["rate_auc"].is_array());
        if result.strategy == "full-observation" {
            assert_eq!(
                (number("final_map_quality"), number("final_coverage")),
                (1.0, 1.0),
                "{}",
                result.world
            );
        }
        // Whole seconds, the last at the end.
        let curve = result.entry["log_error"].as_array().unwrap();
        let times: Vec<u64> = curve.iter().map(|point| point[0].as_u64().unwrap()).collect();
        assert!(times.is_sorted_by(|a, b| a < b) && times.last() == Some(&60), "{times:?}");
    }
    let mut table = csv::Reader::from_path(run.out("trials.csv")).unwrap();
    assert_eq!(table.headers().unwrap().iter().nth(4), Some("time_s"));
    assert_eq!(table.records().count() % (2 * 3), 0);
    assert!(run.out("curves.svg").exists() && run.out("curves-house-3.png").exists());
}

#[test]
fn results_are_the_same_on_any_number_of_threads() {
    let [one, three] = [1, 3].map(|threads| same::files(&ran(&format!("{SHORT} --threads {threads}"))));
    assert!(one == three);
}

#[test]
fn a_saved_house_is_the_one_that_was_made_and_runs_in_four_rooms() {
    let common = "--duration 20s --strategy random";
    // As the robot of `four_rooms`.
    let run = ran(&format!("{common} --unseen-first --generate 2 --seed 11 --save-worlds"));
    let saved: Vec<String> =
        names(&run.path("out")).into_iter().filter(|name| name.ends_with(".toml")).collect();
    assert_eq!(saved, ["house-11.toml", "house-12.toml"]);
    for (result, name) in results(&run).iter().zip(saved) {
        let file = run.out(&name).display().to_string();
        let again = results(&ran(&format!("{common} --unseen-first --seed 11 --world {file}")));
        assert_eq!(again[0].hashes, result.hashes);
        let alone = Run::quiet(&format!("{common} --seed 11 --world {file}"));
        assert_eq!(alone.summary().hash(), result.hashes[0].1);
    }
}

#[test]
fn worlds_are_listed() {
    Run::of("house_trials").goes_well("--list-worlds").prints(&["\nhouse "]);
}

#[test]
fn invalid_input_is_refused() {
    let run = Run::of("house_trials");
    for (arguments, says) in [
        ("--duration 0.5", "must be whole seconds"),
        ("--duration 0", "must be a time above 0"),
        ("--strategy clever", "[possible values: curious, recency"),
        ("--save-worlds", "--generate <N>"),
        ("--seeds 0", "0 is not in 1..="),
        ("--world two_blocks", "`two_blocks` is a grid world"),
        ("--world house --calendar office", "--calendar changes only generated worlds"),
        ("--world house --kind office", "--kind changes only generated worlds"),
    ] {
        let message = run.refuses(arguments);
        assert!(message.contains(says), "{arguments}: {message}");
    }
    run.write("twin.toml", include_str!("../../worlds/house.toml"));
    insta::assert_snapshot!(run.refuses("--world house --world twin.toml"), @"error: two worlds have the name `house`: results are listed by name, so give each world its own name");
}

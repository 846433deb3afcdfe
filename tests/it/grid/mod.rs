//! Trials in grid worlds, and their report.

mod bad_input;
mod choices;
mod ending;
mod files;
mod golden;
mod report;
pub(crate) mod same;
mod walls;
mod worlds;

use crate::run::Run;
use serde_json::Value;

/// A finished run without output on the screen; arguments are separated by spaces.
fn ran(arguments: &str) -> Run {
    let run = Run::of("grid_world");
    run.goes_well(&format!("--quiet {arguments}"));
    run
}

/// `report.json`.
pub(crate) fn report(run: &Run) -> Value {
    serde_json::from_slice(&std::fs::read(run.out("report.json")).unwrap()).unwrap()
}

/// The result of one strategy with one estimator in one world.
pub(crate) struct Result {
    pub(crate) world: String,
    estimator: String,
    pub(crate) strategy: String,
    /// The entry in `report.json`.
    pub(crate) entry: Value,
    /// The hash of everything that was learned, by seed, from `trials.csv`.
    pub(crate) hashes: Vec<(String, String)>,
}

/// World, estimator, strategy, seed and hash of every trial, in the order of `trials.csv`.
fn hashes(run: &Run) -> Vec<[String; 5]> {
    let mut table = csv::Reader::from_path(run.out("trials.csv")).unwrap();
    assert_eq!(table.headers().unwrap().iter().next_back(), Some("map_hash"));
    let rows = table.records().map(|row| {
        let row = row.unwrap();
        [0, 1, 2, 3, row.len() - 1].map(|column| row[column].to_owned())
    });
    let mut trials: Vec<[String; 5]> = rows.collect();
    trials.dedup();
    trials
}

/// All results, except those over all worlds.
pub(crate) fn results(run: &Run) -> Vec<Result> {
    let report = report(run);
    let trials = hashes(run);
    let mut results = Vec::new();
    for run in report["runs"].as_array().unwrap() {
        let text = |key: &str| run[key].as_str().unwrap().to_owned();
        if text("world").starts_with("all worlds") {
            continue;
        }
        for (strategy, entry) in run["strategies"].as_object().unwrap() {
            let (world, estimator) = (text("world"), text("estimator"));
            let is_own =
                |trial: &&[String; 5]| trial[..3] == [&world, &estimator, strategy].map(String::as_str);
            let own = trials.iter().filter(is_own);
            let hashes = own.map(|trial| (trial[3].clone(), trial[4].clone())).collect();
            let (strategy, entry) = (strategy.clone(), entry.clone());
            results.push(Result { world, estimator, strategy, entry, hashes });
        }
    }
    results
}

/// The only hash of a run of one trial.
fn hash(arguments: &str) -> String {
    let results = results(&ran(arguments));
    let [result] = &results[..] else { panic!("{arguments} makes {} results", results.len()) };
    let [(_, hash)] = &result.hashes[..] else { panic!("{arguments} makes more than one trial") };
    hash.clone()
}

/// A row of `trials.csv`.
#[derive(Debug, serde::Deserialize)]
struct Row {
    world: String,
    estimator: String,
    strategy: String,
    seed: u64,
    step: u64,
    rate_error: Option<f64>,
    log_error: Option<f64>,
    map_quality: f64,
}

fn rows(run: &Run) -> Vec<Row> {
    let mut table = csv::Reader::from_path(run.out("trials.csv")).unwrap();
    table.deserialize().map(|row| row.unwrap()).collect()
}

/// The possible values of an option, as the program's `-h` lists them.
pub(crate) fn values(run: &Run, option: &str) -> Vec<String> {
    let help = run.goes_well("-h").stdout;
    let (_, about) = help.split_once(&format!("\n      {option} <")).unwrap();
    let (_, list) = about.split_once("[possible values: ").unwrap();
    let (list, _) = list.split_once(']').unwrap();
    list.split(',').map(|value| value.trim().to_owned()).collect()
}

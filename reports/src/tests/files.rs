//! `report.json` and `trials.csv`, read again.

use super::*;
use interfaces::printable;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

fn json(report: &Report) -> (Value, String) {
    let files = written(report);
    let text = String::from_utf8(files[0].1.clone()).unwrap();
    (serde_json::from_str(&text).unwrap(), text)
}

fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn the_file_has_the_numbers_of_the_report() {
    let report = report(2, &["paper"], &["recency", "curious", "poisson"], 3);
    let (json, text) = json(&report);
    assert_eq!(json["arguments"], serde_json::json!(["--trials", "3"]));
    let runs = json["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 3);
    for (run, expected) in runs.iter().zip(&report.runs) {
        assert_eq!(run["world"], expected.world);
        assert_eq!(run["estimator"], "paper");
        assert_eq!(keys(&run["strategies"]).len(), 3);
        for (name, strategy) in run["strategies"].as_object().unwrap() {
            let result = expected.strategy(name).unwrap();
            for metric in Metric::ALL {
                let curve = strategy[metric.name()].as_array().unwrap();
                assert_eq!(curve.len(), 81);
                let at = result.curve(metric)[80];
                for (index, figure) in [20_000.0, at.mean, at.low, at.high].into_iter().enumerate() {
                    close(curve[80][index].as_f64().unwrap(), figure, 1e-12);
                }
                for measure in [Measure::Final(metric), Measure::Area(metric)] {
                    close(strategy[measure.name()].as_f64().unwrap(), result.value(measure), 1e-12);
                }
            }
            assert_eq!(strategy["strategy_share"], serde_json::json!({ "recency": 0.4, "poisson": 0.6 }));
        }
        let comparisons = run["comparisons"].as_array().unwrap();
        assert_eq!(comparisons.len(), expected.comparisons.len());
        assert_eq!(comparisons[0]["metric"], "log_error_area");
    }
    let files = written(&report);
    assert_eq!(json["files"], serde_json::json!(files[1..].iter().map(|(name, _)| name).collect::<Vec<_>>()));
    let places = ["recency", "curious", "poisson"].map(|name| text.find(&format!("\"{name}\":{{")).unwrap());
    assert!(places.is_sorted(), "strategies stay in their order");
}

#[test]
fn what_is_undefined_is_null() {
    let (json, _) = json(&report(1, &["paper"], &["curious", "recency"], 1));
    let run = &json["runs"][0];
    assert_eq!(run["strategies"]["curious"]["brier"][0], serde_json::json!([0, null, null, null]));
    let comparison = &run["comparisons"][0];
    assert!(comparison["mean_difference"].is_f64());
    for key in ["low", "high", "p_value", "p_holm", "effect_size"] {
        assert_eq!(comparison[key], Value::Null, "{key}");
    }
}

#[test]
fn the_csv_has_a_row_per_trial_and_sample_and_gives_the_report_again() {
    let (settings, trials) = experiment(2, &["paper", "two-state"], &["curious", "recency"], 3);
    let bytes = trial_file(&settings, &trials);
    let report = Report::new(settings, trials);
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let head: Vec<String> = reader.headers().unwrap().iter().map(String::from).collect();
    assert_eq!(head[..5], ["world", "estimator", "strategy", "seed", "step"]);
    assert_eq!(head[5..24], Metric::ALL.map(Metric::name));
    assert_eq!(head[24..], ["map_hash"]);
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 2 * 2 * 2 * 3 * 81);

    // The area under the log error once more, from the rows alone.
    let mut curves: BTreeMap<[String; 4], Vec<(f64, f64)>> = BTreeMap::new();
    for row in &rows {
        let key = [0, 1, 2, 3].map(|column| row[column].to_owned());
        curves.entry(key).or_default().push((row[4].parse().unwrap(), row[6].parse().unwrap()));
        assert_eq!(row[13].is_empty(), row[4].parse::<u64>().unwrap() < 30, "undefined is empty");
    }
    for run in report.runs.iter().filter(|run| run.worlds == 1) {
        for strategy in &run.strategies {
            let wanted = [&run.world, &run.estimator, &strategy.name];
            let own = curves.iter().filter(|(key, _)| key.iter().zip(wanted).all(|(a, b)| a == b));
            let piece = |ends: &[(f64, f64)]| (ends[1].0 - ends[0].0) * (ends[0].1 + ends[1].1) / 2.0;
            let areas: Vec<f64> =
                own.map(|(_, curve)| curve.windows(2).map(piece).sum::<f64>() / HORIZON as f64).collect();
            assert_eq!(areas.len(), 3);
            close(areas.iter().sum::<f64>() / 3.0, strategy.value(Measure::PRIMARY), 1e-12);
        }
    }
}

#[test]
fn a_name_is_no_formula_in_the_csv() {
    for (name, mark) in [
        ("=1+1", "'"),
        ("+1", "'"),
        ("-1", "'"),
        ("@SUM(A1)", "'"),
        ("two, \"blocks\"", ""),
        ("x\t\u{1b}[2J\n", ""),
    ] {
        let (settings, mut trials) = experiment(1, &["paper"], &["curious"], 1);
        trials[0].world = name.into();
        let bytes = trial_file(&settings, &trials);
        let mut reader = csv::Reader::from_reader(bytes.as_slice());
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        assert!(
            rows.iter().all(|row| row[0] == format!("{mark}{}", printable(name))),
            "{name:?}: {:?}",
            rows[0]
        );
    }
}

/// `trials.csv`.
fn trial_file(settings: &ReportSettings, trials: &[Trial]) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let report = collect::<Box<dyn std::error::Error>>(settings.clone(), folder.path(), trials).unwrap();
    assert_eq!(report.finished, trials.len() as u64);
    std::fs::read(folder.path().join("trials.csv")).unwrap()
}

#[test]
fn trials_that_cannot_be_written_are_an_error() {
    let (settings, mut trials) = experiment(1, &["paper"], &["curious"], 3);
    let folder = tempfile::tempdir().unwrap();
    let collected = |folder: &Path, trials: &[Trial]| {
        collect::<Box<dyn std::error::Error>>(settings.clone(), folder, trials).unwrap_err().to_string()
    };
    trials[1].samples.pop();
    assert_eq!(collected(folder.path(), &trials), "trials are not sampled at the same times");
    let nowhere = collected(Path::new("no/such/folder"), &[]);
    assert!(nowhere.starts_with("cannot write no/such/folder/trials.csv: "), "{nowhere}");
}

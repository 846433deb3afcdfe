//! `report.json` agrees with `trials.csv`.

use super::{Row, ran, report, rows};
use crate::run::Run;
use serde_json::Value;
use std::sync::LazyLock;

/// Two worlds, two estimators, three strategies, three seeds.
static RUN: LazyLock<Run> = LazyLock::new(|| {
    ran(
        "--steps 600 --trials 3 --world two_blocks --world open_hall --estimator paper --estimator two-state \
         --strategy curious --strategy recency --strategy poisson",
    )
});

const STRATEGIES: [&str; 3] = ["curious", "poisson", "recency"];

/// A number, or a value that is not a number.
fn number(value: &Value) -> f64 {
    match value {
        Value::Null => f64::NAN,
        value => value.as_f64().unwrap_or_else(|| panic!("{value} is neither a number nor null")),
    }
}

/// A column of `trials.csv`.
type Column = fn(&Row) -> f64;

/// The values at the end of every trial of a strategy, in the order of the seeds.
fn at_the_end(rows: &[Row], [world, estimator, strategy]: [&str; 3], value: Column) -> Vec<f64> {
    let is_asked = |row: &&Row| {
        row.step == 600 && row.world == world && row.estimator == estimator && row.strategy == strategy
    };
    let mut ends: Vec<&Row> = rows.iter().filter(is_asked).collect();
    ends.sort_by_key(|row| row.seed);
    ends.into_iter().map(value).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn it_agrees_with_the_trials() {
    let (report, rows) = (report(&RUN), rows(&RUN));
    let values: [(&str, Column); 3] = [
        ("final_rate_error", |row| row.rate_error.unwrap()),
        ("final_log_error", |row| row.log_error.unwrap()),
        ("final_map_quality", |row| row.map_quality),
    ];
    let mut compared = 0;
    for run in report["runs"].as_array().unwrap() {
        let [world, estimator] = ["world", "estimator"].map(|key| run[key].as_str().unwrap());
        if world.starts_with("all worlds") {
            continue;
        }
        for (name, value) in values {
            let ends = |strategy| at_the_end(&rows, [world, estimator, strategy], value);
            for strategy in STRATEGIES {
                assert_eq!(ends(strategy).len(), 3);
                let reported = number(&run["strategies"][strategy][name]);
                assert!((reported - mean(&ends(strategy))).abs() < 1e-12, "{name} of {strategy} in {world}");
            }
            for comparison in run["comparisons"].as_array().unwrap().iter().filter(|it| it["metric"] == name)
            {
                let [a, b] = ["a", "b"].map(|key| ends(comparison[key].as_str().unwrap()));
                let differences: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
                assert!((number(&comparison["mean_difference"]) - mean(&differences)).abs() < 1e-12);
                compared += 1;
            }
        }
    }
    assert!(compared > 0, "nothing was compared");
}

#[test]
fn nothing_changes_where_nothing_moves() {
    for result in super::results(&RUN) {
        assert_eq!(result.entry["false_change_events"], 0, "{} in {}", result.strategy, result.world);
        assert_eq!(result.entry["final_false_rate"], 0.0, "{} in {}", result.strategy, result.world);
    }
}

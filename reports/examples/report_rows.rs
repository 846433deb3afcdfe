//! Keeps what pages show of experiments: of `report.json`, the runs over all worlds, or those of each world, as rows.
//!
//! ```text
//! cargo run -p curious-reports --example report_rows -- --made "docs/clusters/study.sh" --to docs/results/grid_study \
//!   grid-5000=study/grid-5000/report.json grid-20000=study/grid-20000/report.json
//! cargo run -p curious-reports --example page_tables -- docs/*.md
//! ```
//!
//! It writes `docs/results/grid_study.csv`, with a row per experiment, estimator and strategy, and
//! `docs/results/grid_study_pairs.csv`, with a row per pair of strategies and measure.

use anyhow::{Context, ensure};
use clap::Parser;
use reports::pages::write_rows;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Rows of experiments.
#[derive(Parser)]
struct Args {
    /// The command of the experiments, for the first line of the files
    #[arg(long)]
    made: String,
    /// The files, without `.csv`
    #[arg(long)]
    to: PathBuf,
    /// Keeps each world, and not all worlds together; without pairs of strategies
    #[arg(long)]
    each: bool,
    /// `NAME=FILE`: what the experiment is called in the rows, and its `report.json`
    #[arg(required = true, value_parser = named)]
    reports: Vec<(String, PathBuf)>,
}

fn named(word: &str) -> Result<(String, PathBuf), String> {
    let (name, file) = word.split_once('=').ok_or("expected NAME=FILE")?;
    Ok((name.to_owned(), file.into()))
}

/// What is read of `report.json`. The curves, which are most of it, are passed over.
#[derive(Deserialize)]
struct Report {
    runs: Vec<Run>,
}

#[derive(Deserialize)]
struct Run {
    world: String,
    estimator: String,
    #[serde(deserialize_with = "in_order")]
    strategies: Vec<(String, StrategyRow)>,
    comparisons: Vec<PairRow>,
}

/// An object as pairs, in their order: that of the experiment.
fn in_order<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<(String, StrategyRow)>, D::Error> {
    struct Pairs;
    impl<'de> Visitor<'de> for Pairs {
        type Value = Vec<(String, StrategyRow)>;

        fn expecting(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            to.write_str("an object with a strategy per key")
        }

        fn visit_map<M: MapAccess<'de>>(self, mut object: M) -> Result<Self::Value, M::Error> {
            let mut pairs = Vec::new();
            while let Some(pair) = object.next_entry()? {
                pairs.push(pair);
            }
            Ok(pairs)
        }
    }
    from.deserialize_map(Pairs)
}

impl Run {
    fn is_of_all_worlds(&self) -> bool {
        self.world.starts_with("all worlds")
    }
}

/// A strategy with an estimator in an experiment: means over the worlds, but for the last two, which are sums. Measures that are not
/// defined are empty.
#[derive(Clone, Default, Deserialize, Serialize)]
struct StrategyRow {
    #[serde(default)]
    experiment: String,
    #[serde(default)]
    world: String,
    #[serde(default)]
    estimator: String,
    #[serde(default)]
    strategy: String,
    /// The area of the log error, divided by that of `curious`.
    to_curious: Option<f64>,
    trials: usize,
    log_error_area: Option<f64>,
    final_log_error: Option<f64>,
    log_error_of_range_area: Option<f64>,
    final_log_error_of_range: Option<f64>,
    final_rate_auc: Option<f64>,
    final_coverage: Option<f64>,
    final_map_quality: Option<f64>,
    final_map_quality_changing: Option<f64>,
    final_changing_share: Option<f64>,
    final_brier: Option<f64>,
    brier_area: Option<f64>,
    brier_last_seen_area: Option<f64>,
    brier_mean_area: Option<f64>,
    final_predictive_deviance: Option<f64>,
    final_predictive_deviance_known: Option<f64>,
    final_passages_log_error: Option<f64>,
    final_busiest_tenth_hit: Option<f64>,
    false_change_events: u64,
    collisions: Option<u64>,
}

/// The difference a − b of two strategies, paired by world.
#[derive(Clone, Default, Deserialize, Serialize)]
struct PairRow {
    #[serde(default)]
    experiment: String,
    #[serde(default)]
    estimator: String,
    metric: String,
    a: String,
    b: String,
    pairs: usize,
    mean_difference: f64,
    #[serde(skip_serializing)]
    low: Option<f64>,
    #[serde(skip_serializing)]
    high: Option<f64>,
    /// Half of the 95 % confidence interval.
    half_interval: Option<f64>,
    p_value: Option<f64>,
    /// With Holm's correction for all pairs of the experiment.
    p_holm: Option<f64>,
    ratio: Option<f64>,
}

/// The measures of pairs that pages show.
const METRICS: [&str; 2] = ["log_error_area", "final_map_quality"];

fn main() -> anyhow::Result<()> {
    let args = Args::parse();
    let (mut strategies, mut pairs) = (Vec::new(), Vec::new());
    for (name, path) in &args.reports {
        let text =
            std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        let report: Report =
            serde_json::from_str(&text).with_context(|| format!("{} is no report", path.display()))?;
        let before = strategies.len();
        for run in report.runs.iter().filter(|run| run.is_of_all_worlds() != args.each) {
            strategies.extend(strategy_rows(name, run));
            pairs.extend(pair_rows(name, run));
        }
        ensure!(strategies.len() > before, "{} has no such runs", path.display());
    }
    write(&args.to.with_extension("csv"), &args.made, &strategies)?;
    if args.each || pairs.is_empty() {
        return Ok(());
    }
    let mut name = args.to.file_name().unwrap_or_default().to_owned();
    name.push("_pairs.csv");
    write(&args.to.with_file_name(name), &args.made, &pairs)
}

fn write<R: Serialize>(path: &Path, made: &str, rows: &[R]) -> anyhow::Result<()> {
    write_rows(path, made, rows).with_context(|| format!("cannot write {}", path.display()))
}

fn strategy_rows(experiment: &str, run: &Run) -> Vec<StrategyRow> {
    let curious = run.strategies.iter().find(|(name, _)| name == "curious");
    let curious = curious.and_then(|(_, row)| row.log_error_area);
    let row = |(strategy, row): &(String, StrategyRow)| StrategyRow {
        experiment: experiment.to_owned(),
        world: run.world.clone(),
        estimator: run.estimator.clone(),
        strategy: strategy.clone(),
        to_curious: row.log_error_area.zip(curious).map(|(own, curious)| own / curious),
        ..row.clone()
    };
    run.strategies.iter().map(row).collect()
}

fn pair_rows(experiment: &str, run: &Run) -> Vec<PairRow> {
    let row = |pair: &PairRow| PairRow {
        experiment: experiment.to_owned(),
        estimator: run.estimator.clone(),
        half_interval: pair.high.zip(pair.low).map(|(high, low)| (high - low) / 2.0),
        ..pair.clone()
    };
    run.comparisons.iter().filter(|pair| METRICS.contains(&pair.metric.as_str())).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use reports::pages::{Rows, columns_of};

    const REPORT: &str = r#"{"seed": 1, "runs": [
        {"world": "a", "estimator": "paper", "strategies": {}, "comparisons": []},
        {"world": "all worlds (2)", "estimator": "paper", "claim": null, "strategies": {
            "curious": {"trials": 2, "log_error_area": 2.0, "false_change_events": 1, "collisions": 4},
            "best": {"trials": 2, "log_error_area": 0.5, "final_brier": null, "false_change_events": 3, "log_error": [[1, 2, 3, 4]]}},
         "comparisons": [
            {"a": "curious", "b": "best", "metric": "log_error_area", "pairs": 2, "mean_b": 0.5, "mean_difference": 1.5,
             "low": 1.0, "high": 2.0, "p_value": 0.25, "p_holm": 0.5, "ratio": 4.0, "effect_size": 1.0},
            {"a": "curious", "b": "best", "metric": "final_brier", "pairs": 2, "mean_difference": 0}]}]}"#;

    #[test]
    fn runs_over_all_worlds_become_rows() {
        let report: Report = serde_json::from_str(REPORT).unwrap();
        let rows = strategy_rows("e", &report.runs[1]);
        assert_eq!(rows.iter().map(|row| row.strategy.as_str()).collect::<Vec<_>>(), ["curious", "best"]);
        assert_eq!((rows[1].to_curious, rows[1].false_change_events), (Some(0.25), 3));
        let pairs = pair_rows("e", &report.runs[1]);
        assert_eq!((pairs.len(), pairs[0].half_interval), (1, Some(0.5)));
    }

    /// Files with other columns are older than the program.
    #[test]
    fn files_have_the_columns_of_this_program() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/results");
        let columns =
            |file: &str| Rows::of_csv(&std::fs::read_to_string(root.join(file)).unwrap()).unwrap().columns;
        for study in ["grid_study", "grid_strategies", "houses", "houses_hour"] {
            assert_eq!(columns(&format!("{study}.csv")), columns_of(&StrategyRow::default()));
        }
        for study in ["grid_study", "grid_strategies"] {
            assert_eq!(columns(&format!("{study}_pairs.csv")), columns_of(&PairRow::default()));
        }
    }
}

//! The tables of `docs/results.md`, from the `summary.json` files of `four_rooms` runs.
//!
//! Runs of the same world are one column; each entry is the mean over these runs and, in brackets, the worst run. With `--keep
//! FILE`, the values of the runs are added to a small file that is kept beside the page; `--page PAGE` writes the tables of a page anew from
//! such files: those between `<!-- results_table FILE: WORLD, WORLD -->` and `<!-- end -->`. A test checks that the page has what its
//! files say, and that `summary.json` still has every value.
//!
//! ```sh
//! for world in four_rooms toy_on_the_floor turned_house house office warehouse cave yard; do
//!   for seed in 0 1 2; do
//!     cargo run --bin four_rooms -- --no-rrd --quiet --world $world --seed $seed --out results/${world}_$seed
//!   done
//! done
//! cargo run --example results_table -- results/*/summary.json     # prints the table
//! cargo run --example results_table -- --keep docs/results/worlds.json --made "$(date -I), $(git rev-parse --short HEAD)" \
//!   --page docs/results.md results/*/summary.json
//! ```

use anyhow::{Context, bail, ensure};
use clap::Parser;
use reports::pages::with_tables;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::fs::{read_to_string, write};
use std::path::{Path, PathBuf};

/// Whether the worst run is the one with the smallest or with the largest value.
enum Worst {
    Smallest,
    Largest,
}
use Worst::{Largest, Smallest};

/// A row: its title, where the value is in `summary.json`, a factor, the number of decimals, the unit.
type Row = (&'static str, &'static str, f64, usize, &'static str, Worst);

const ROWS: [Row; 28] = [
    ("seen, of the cells in sight of reachable places", "/coverage_reachable", 100.0, 1, " %", Smallest),
    ("seen, of all free cells and their borders", "/coverage", 100.0, 1, " %", Smallest),
    ("map correct, of the cells in sight of reachable places", QUALITY_REACHABLE, 100.0, 1, " %", Smallest),
    ("map correct, of all free cells and their borders", "/map_quality", 100.0, 1, " %", Smallest),
    ("changing cells in view, balanced accuracy", "/map_quality_changing", 100.0, 1, " %", Smallest),
    ("changing cells out of view, balanced accuracy", OUT_OF_VIEW, 100.0, 1, " %", Smallest),
    ("the same, in the predicted map", PREDICTED, 100.0, 1, " %", Smallest),
    ("Brier score out of view, predicted map", "/predicted/brier", 1.0, 3, "", Largest),
    ("Brier score out of view, as last seen", "/predicted/brier_last_seen", 1.0, 3, "", Largest),
    ("Brier score out of view, share of time blocked", "/predicted/brier_mean", 1.0, 3, "", Largest),
    ("Brier score out of view, true chains", "/predicted/brier_true_chains", 1.0, 3, "", Largest),
    ("false change events on static cells", "/false_change_events", 1.0, 0, "", Largest),
    ("false map changes on static cells", "/false_map_changes", 1.0, 0, "", Largest),
    ("rate error, cells in view for 3 cycles or more", "/rate_error", 1.0, 2, "", Largest),
    ("rate error, all changing cells", "/rate_error_all", 1.0, 2, "", Largest),
    ("log error of the rates", "/log_error", 1.0, 2, "", Largest),
    ("the same, where a pass over a part of a cell may count", OF_RANGE, 1.0, 2, "", Largest),
    ("rate AUC, changing against static cells", "/rate_auc", 1.0, 3, "", Smallest),
    ("block event to map, median", "/block_latency/median_s", 1.0, 1, " s", Largest),
    ("block events never noticed", "/block_latency/never_noticed", 100.0, 1, " %", Largest),
    ("free event to map, median", "/free_latency/median_s", 1.0, 1, " s", Largest),
    ("free events never noticed", "/free_latency/never_noticed", 100.0, 1, " %", Largest),
    ("longest time since a cell was seen", "/age/max_s", 1.0, 0, " s", Largest),
    ("contacts by the robot's own motion", "/contacts/own_motion", 1.0, 0, "", Largest),
    ("contacts in which something ran into it", "/contacts/run_into", 1.0, 0, "", Largest),
    ("goals reached", "/goals/reached", 1.0, 0, "", Smallest),
    ("goals approached (nearest reachable point)", "/goals/approached", 1.0, 0, "", Largest),
    ("goals given up", "/goals/given_up", 1.0, 0, "", Largest),
];
const OF_RANGE: &str = "/log_error_of_range";
const QUALITY_REACHABLE: &str = "/map_quality_reachable";
const PREDICTED: &str = "/predicted/balanced_accuracy_out_of_view";
const OUT_OF_VIEW: &str = "/map_quality_changing_out_of_view";

/// Tables of runs of `four_rooms`.
#[derive(Parser)]
struct Args {
    /// The `summary.json` files of runs
    summaries: Vec<PathBuf>,
    /// Write the values of these runs to FILE
    #[arg(long, value_name = "FILE", requires = "made")]
    keep: Option<PathBuf>,
    /// When and from which sources the runs were made: a date, a commit
    #[arg(long)]
    made: Option<String>,
    /// Write the tables of PAGE anew
    #[arg(long)]
    page: Option<PathBuf>,
}

/// What the tables need of the runs.
#[derive(Serialize, Deserialize)]
struct Kept {
    /// When and from which sources.
    made: String,
    /// Each with its world, its seed, and the values by their place in `summary.json`.
    runs: Vec<Map<String, Value>>,
}

fn main() -> anyhow::Result<()> {
    let args = Args::parse();
    ensure!(
        args.page.is_some() || !args.summaries.is_empty(),
        "give the summary.json files of one or more runs"
    );
    let runs = args.summaries.iter().map(|path| values(path)).collect::<anyhow::Result<Vec<_>>>()?;
    if let (Some(path), Some(made)) = (&args.keep, args.made) {
        let text = serde_json::to_string_pretty(&Kept { made, runs: runs.clone() })?;
        write(path, text + "\n").with_context(|| format!("cannot write {}", path.display()))?;
    }
    match args.page {
        Some(page) => {
            let text = read_to_string(&page).with_context(|| format!("cannot read {}", page.display()))?;
            write(&page, rewritten(&text)?).with_context(|| format!("cannot write {}", page.display()))?;
        }
        None => print!("{}", table(&runs)),
    }
    Ok(())
}

/// The values of a run that are in the table.
fn values(path: &Path) -> anyhow::Result<Map<String, Value>> {
    let text = read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let run: Value =
        serde_json::from_str(&text).with_context(|| format!("{} is not JSON", path.display()))?;
    ensure!(run["world"].is_string(), "{} is not a summary.json", path.display());
    let keys = ["/world", "/seed"].into_iter().chain(ROWS.iter().map(|row| row.1));
    Ok(keys.filter_map(|key| Some((key.to_owned(), run.pointer(key)?.clone()))).collect())
}

/// One column for each world, in the order of their first runs.
fn table(runs: &[Map<String, Value>]) -> String {
    let mut worlds: Vec<(&str, Vec<&Map<String, Value>>)> = Vec::new();
    for run in runs {
        let world = run["/world"].as_str().unwrap_or_default();
        match worlds.iter_mut().find(|(name, _)| *name == world) {
            Some((_, runs)) => runs.push(run),
            None => worlds.push((world, vec![run])),
        }
    }
    let names: Vec<&str> = worlds.iter().map(|(name, _)| *name).collect();
    let mut table = format!("| | {} |\n|---|{}\n", names.join(" | "), "---|".repeat(names.len()));
    for row in &ROWS {
        let entries: Vec<String> = worlds.iter().map(|(_, runs)| entry(row, runs)).collect();
        table += &format!("| {} | {} |\n", row.0, entries.join(" | "));
    }
    table
}

/// A page with all its tables made anew.
fn rewritten(page: &str) -> anyhow::Result<String> {
    let made = |source: &str| table_of(source).map_err(|why| format!("{why:#}"));
    Ok(with_tables(page, "results_table", made)?)
}

/// The table of a file with the worlds that are named after it, and where the runs are from.
fn table_of(source: &str) -> anyhow::Result<String> {
    let Some((file, worlds)) = source.split_once(": ") else { bail!("`{source}`: name a file and worlds") };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let text = read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let kept: Kept = serde_json::from_str(&text).with_context(|| format!("{file} has no runs"))?;
    let runs: Vec<_> = worlds
        .split(", ")
        .flat_map(|world| kept.runs.iter().filter(move |run| run["/world"].as_str() == Some(world)).cloned())
        .collect();
    ensure!(!runs.is_empty(), "{file} has no runs of {worlds}");
    Ok(format!("{}\nMade {}.", table(&runs), kept.made))
}

/// The mean over the runs that have a value, and the worst of them in brackets.
fn entry((_, key, factor, decimals, unit, worst): &Row, runs: &[&Map<String, Value>]) -> String {
    let value = |run: &&Map<String, Value>| Some(run.get(*key)?.as_f64()? * factor);
    let values: Vec<f64> = runs.iter().filter_map(value).collect();
    if values.is_empty() {
        return "–".to_owned();
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let worst = match worst {
        Smallest => values.iter().copied().fold(f64::INFINITY, f64::min),
        Largest => values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    };
    format!("{mean:.decimals$}{unit} ({worst:.decimals$})")
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = include_str!("../docs/results.md");
    const SCHEMA: &str = include_str!("../tests/schemas/four_rooms-2.txt");

    #[test]
    fn the_page_has_what_its_files_say() {
        assert!(PAGE.matches("<!-- results_table ").count() >= 2);
        assert!(
            rewritten(PAGE).unwrap() == PAGE,
            "cargo run --example results_table -- --page docs/results.md"
        );
    }

    #[test]
    fn summaries_still_have_every_value() {
        for (title, key, ..) in ROWS {
            assert!(SCHEMA.lines().any(|line| line.split(' ').next() == Some(key)), "{title}: {key}");
        }
    }
}

//! Prints a table of `docs/results.md` from the `summary.json` files of `four_rooms` runs.
//!
//! Runs of the same world are one column; each entry is the mean over these runs and, in brackets, the
//! worst run.
//!
//! ```sh
//! for world in four_rooms toy_on_the_floor turned_house house office warehouse cave yard; do
//!   for seed in 0 1 2; do
//!     cargo run --bin four_rooms -- --no-rrd --quiet --world $world --seed $seed --out results/${world}_$seed
//!   done
//! done
//! cargo run --example results_table -- results/{house,office,warehouse,cave,yard}_?/summary.json
//! ```

use anyhow::{Context, ensure};
use serde_json::Value;

/// Whether the worst run is the one with the smallest or with the largest value.
enum Worst {
    Smallest,
    Largest,
}
use Worst::{Largest, Smallest};

/// A row: its title, where the value is in `summary.json`, a factor, the number of decimals, the unit.
type Row = (&'static str, &'static str, f64, usize, &'static str, Worst);

const ROWS: [Row; 29] = [
    ("seen, of the cells in sight of reachable places", "/coverage_reachable", 100.0, 1, " %", Smallest),
    ("seen, of all free cells and their borders", "/coverage", 100.0, 1, " %", Smallest),
    ("map right, of the cells in sight of reachable places", QUALITY_REACHABLE, 100.0, 1, " %", Smallest),
    ("map right, of all free cells and their borders", "/map_quality", 100.0, 1, " %", Smallest),
    ("changing cells in view, balanced accuracy", "/map_quality_changing", 100.0, 1, " %", Smallest),
    ("changing cells out of view, balanced accuracy", OUT_OF_VIEW, 100.0, 1, " %", Smallest),
    ("the same, as predicted now", PREDICTED, 100.0, 1, " %", Smallest),
    ("Brier score out of view, predicted", "/predicted/brier", 1.0, 3, "", Largest),
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
    ("times real time, without recording", "/real_time_factor", 1.0, 0, "", Smallest),
];
const OF_RANGE: &str = "/log_error_of_range";
const QUALITY_REACHABLE: &str = "/map_quality_reachable";
const PREDICTED: &str = "/predicted/balanced_accuracy_out_of_view";
const OUT_OF_VIEW: &str = "/map_quality_changing_out_of_view";

fn main() -> anyhow::Result<()> {
    let mut worlds: Vec<(String, Vec<Value>)> = Vec::new();
    for path in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&path).with_context(|| format!("cannot read {path}"))?;
        let run: Value = serde_json::from_str(&text).with_context(|| format!("{path} is not JSON"))?;
        let world =
            run["world"].as_str().with_context(|| format!("{path} is not a summary.json"))?.to_owned();
        match worlds.iter_mut().find(|(name, _)| *name == world) {
            Some((_, runs)) => runs.push(run),
            None => worlds.push((world, vec![run])),
        }
    }
    ensure!(!worlds.is_empty(), "give the summary.json files of one or more runs");

    let names: Vec<&str> = worlds.iter().map(|(name, _)| name.as_str()).collect();
    println!("| | {} |", names.join(" | "));
    println!("|---|{}", "---|".repeat(names.len()));
    for row in &ROWS {
        let entries: Vec<String> = worlds.iter().map(|(_, runs)| entry(row, runs)).collect();
        println!("| {} | {} |", row.0, entries.join(" | "));
    }
    Ok(())
}

/// The mean over the runs that have a value, and the worst of them in brackets.
fn entry((_, key, factor, decimals, unit, worst): &Row, runs: &[Value]) -> String {
    let value = |run: &Value| Some(run.pointer(key)?.as_f64()? * factor);
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

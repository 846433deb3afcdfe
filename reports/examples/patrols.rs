//! Where should a robot look, to keep its map fresh? Strategies in generated buildings with a calendar.
//!
//! ```text
//! cargo run -p curious-reports --example patrols -- --kind home --kind office --buildings 50 --csv study.csv
//! cargo run -p curious-reports --example patrols -- --buildings 50 --shard 1/3 --csv shard-1.csv       # and 2/3, 3/3
//! cargo run -p curious-reports --example patrols -- --merge shard-1.csv shard-2.csv shard-3.csv
//! ```
//!
//! Every strategy has the same buildings, and the same changes in them. A column `÷ X` is the Brier score divided by that of
//! X (ratio of the means), with the p-value of the paired t test of the differences. Delays are those of changes that last an
//! hour or more, by belief: median and 95 % point, each the mean over the buildings, and the share that was missed. *Lost* is the
//! time that users lose per trip between two places, since doors that the map believed open are closed, and *not made* the share of
//! the possible trips for which the map showed no open way. Files from before these two columns are read; there, both are NaN.
//!
//! With `--strategy bound`, a second table has the lower bound of the Brier score of all strategies (B ÷ bound: ratio of the
//! means), and the freshness regret of each building: (B − bound) ÷ (B without looks − bound), 0 at the bound and 1 without any
//! use of looks. B without looks is that of a robot that knows the habits. Its columns `÷ X` are ratios of mean regrets, with the
//! p-value of the paired t test.
//!
//! `--merge … --page docs/strategies.md` writes the tables of that page anew.
//!
//! A file of `--csv` gets a line per run as soon as it ends. A study that was stopped goes on where it was: what the file has is
//! not computed again. The order is by buildings, so that a study that is not complete still has all strategies.

#[path = "patrols/cells.rs"]
mod cells;
#[path = "patrols/page.rs"]
mod page;
#[path = "patrols/rows.rs"]
mod rows;
#[path = "patrols/runs.rs"]
mod runs;
#[path = "patrols/tables.rs"]
mod tables;

use anyhow::{Context, ensure};
use clap::Parser;
use days::{Habits, Kind};
use rayon::prelude::*;
use rows::{Row, RowFile};
use runs::{Run, STRATEGIES};
use std::path::PathBuf;

#[derive(Parser)]
struct Options {
    /// Kinds of buildings: home, office, warehouse, clinic
    #[arg(long, default_values = ["home", "office"])]
    kind: Vec<Kind>,
    /// Whether the robot knows the habits of the things: known, learned (from its looks), or, to see what learning costs,
    /// known-to-plan (only the predictions are learned) and known-to-predict (only the plans are)
    #[arg(long, default_values = ["known"])]
    habits: Vec<Habits>,
    /// The number of buildings of each kind
    #[arg(long, default_value_t = 100)]
    buildings: u64,
    /// The seed of the first building; strategies were tuned on seeds from 100000 on
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The share of the time that the robot can be on patrol, above 0, at most 1
    #[arg(long, default_values_t = [1.0, 0.05, 0.01], value_parser = share)]
    duty: Vec<f64>,
    /// no-looks, curious, round, coverage, gain, bound: all but the bound, which takes most of the time
    #[arg(long, default_values = &STRATEGIES[..5], value_parser = STRATEGIES)]
    strategy: Vec<String>,
    /// Simulated days
    #[arg(long, default_value_t = 7.0, value_parser = positive)]
    days: f64,
    /// The length of a patrol of the strategies that do not choose it, min: at most 30 [default: 2.5 in homes, otherwise 3.5].
    /// With several of them, each has its rows
    #[arg(long, value_parser = minutes)]
    length: Vec<f64>,
    /// Computes a part: K/N has the buildings whose number, from 1 on, is K, K + N, …
    #[arg(long, value_parser = shard)]
    shard: Option<[u64; 2]>,
    /// A table of all runs, which is completed
    #[arg(long)]
    csv: Option<PathBuf>,
    /// Computes nothing: prints the tables of these files
    #[arg(long, num_args = 1.., conflicts_with = "csv")]
    merge: Vec<PathBuf>,
    /// Writes the tables of this page anew, from the files of --merge
    #[arg(long, value_name = "PAGE", requires = "merge")]
    page: Option<PathBuf>,
}

fn share(word: &str) -> Result<f64, String> {
    let value = word.parse::<f64>().ok().filter(|value| *value > 0.0 && *value <= 1.0);
    value.ok_or_else(|| "expected a number above 0 and at most 1".to_owned())
}

fn positive(word: &str) -> Result<f64, String> {
    let value = word.parse::<f64>().ok().filter(|value| *value > 0.0 && *value <= 3650.0);
    value.ok_or_else(|| "expected a number above 0 and at most 3650".to_owned())
}

fn minutes(word: &str) -> Result<f64, String> {
    let value = word.parse::<f64>().ok().filter(|value| (1.0..=30.0).contains(value));
    value.ok_or_else(|| "expected a number from 1 to 30".to_owned())
}

fn shard(word: &str) -> Result<[u64; 2], String> {
    let numbers = word.split_once('/').map(|(shard, of)| (shard.parse::<u64>(), of.parse::<u64>()));
    match numbers {
        Some((Ok(shard), Ok(of))) if (1..=of).contains(&shard) => Ok([shard, of]),
        _ => Err("expected a shard as in 2/5".to_owned()),
    }
}

impl Options {
    /// All runs of the study, or of its shard, building by building.
    fn runs(&self) -> Vec<Run> {
        let mut runs = Vec::new();
        let [shard, of] = self.shard.unwrap_or([1, 1]);
        for seed in (self.seed..self.seed + self.buildings).skip(shard as usize - 1).step_by(of as usize) {
            for (kind, habits) in
                self.kind.iter().flat_map(|kind| self.habits.iter().map(move |habits| (kind, habits)))
            {
                for (share, strategy) in self
                    .duty
                    .iter()
                    .flat_map(|share| self.strategy.iter().map(move |strategy| (share, strategy)))
                {
                    runs.extend(Run::all(*kind, *habits, *share, seed, self.days, strategy, &self.length));
                }
            }
        }
        runs
    }
}

fn main() -> anyhow::Result<()> {
    let options = Options::parse();
    if !options.merge.is_empty() {
        let mut rows = Vec::new();
        for path in &options.merge {
            rows.extend(RowFile::read(path).with_context(|| format!("cannot read {}", path.display()))?);
        }
        cells::sort(&mut rows);
        let Some(path) = &options.page else {
            tables::print(&rows);
            return Ok(());
        };
        let text =
            std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        let text = page::rewritten(&text, &rows).with_context(|| format!("in {}", path.display()))?;
        return std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()));
    }
    let runs = options.runs();
    ensure!(!runs.is_empty(), "there is nothing to compute");
    let mut file =
        options.csv.as_deref().map(RowFile::open).transpose().context("cannot use the file of --csv")?;
    let known: Vec<Row> = file.as_ref().map_or_else(Vec::new, |file| file.rows.clone());
    let is_missing = |run: &&Run| !known.iter().any(|row| row.run == **run);
    let missing: Vec<&Run> = runs.iter().filter(is_missing).collect();
    let file = std::sync::Mutex::new(&mut file);
    let new = missing.par_iter().map(|run| {
        let row = run.row();
        if let Ok(mut file) = file.lock()
            && let Some(file) = file.as_mut()
        {
            file.append(&row)?;
        }
        Ok(row)
    });
    let new: anyhow::Result<Vec<Row>> = new.collect();
    let mut rows: Vec<Row> = known.into_iter().filter(|row| runs.contains(&row.run)).collect();
    rows.extend(new?);
    cells::sort(&mut rows);
    tables::print(&rows);
    Ok(())
}

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
//! With `--habits recorded`, the things of the generated buildings repeat what was recorded in real ones: doors the series of
//! `--doors`, other things those of `--others`. The robot learns from its looks. A file has the lines `time_s,state`, one per
//! change: seconds since a midnight, and 1 (a door is open, another thing is present), 0, or nan where nothing was recorded.
//! Files whose names agree up to the first `-` are of one building: their things repeat the same days, without gaps, as long as no
//! series is used twice.
//!
//! `--merge … --page docs/strategies.md` writes the tables of that page anew.
//!
//! A file of `--csv` gets a line per run as soon as it ends. A study that was stopped goes on where it was: what the file has is
//! not computed again. The order is by buildings, so that a study that is not complete still has all strategies.

#[path = "patrols/cells.rs"]
mod cells;
#[path = "patrols/page.rs"]
mod page;
#[path = "patrols/recorded.rs"]
mod recorded;
#[path = "patrols/rows.rs"]
mod rows;
#[path = "patrols/runs.rs"]
mod runs;
#[path = "study/rows.rs"]
mod study;
#[path = "patrols/tables.rs"]
mod tables;

use anyhow::ensure;
use clap::Parser;
use days::Kind;
use recorded::Recorded;
use reports::shards::Shard;
use runs::{BOUND, Run, STRATEGIES, Things};
use std::path::PathBuf;
use study::Study;

#[derive(Parser)]
struct Options {
    /// Kinds of buildings: home, office, warehouse, clinic
    #[arg(long, default_values = ["home", "office"])]
    kind: Vec<Kind>,
    /// Whether the robot knows the habits of the things: known, learned (from its looks), or, to see what learning costs,
    /// known-to-plan (only the predictions are learned) and known-to-predict (only the plans are). recorded: the things repeat
    /// recorded series, see --doors, and the robot learns from its looks
    #[arg(long, default_values = ["known"])]
    habits: Vec<Things>,
    /// Recorded series of doors, for --habits recorded: files with the lines `time_s,state`, where 1 is open
    #[arg(long, num_args = 1.., value_name = "FILE", requires = "others")]
    doors: Vec<PathBuf>,
    /// Recorded series of other things, where 1 is present or occupied
    #[arg(long, num_args = 1.., value_name = "FILE", requires = "doors")]
    others: Vec<PathBuf>,
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
    #[arg(long)]
    shard: Option<Shard>,
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

impl Options {
    /// All runs of the study, or of its shard, building by building.
    fn runs(&self) -> Vec<Run> {
        let mut runs = Vec::new();
        let is_of_shard = |number: u64| self.shard.is_none_or(|shard| shard.has(number));
        for seed in
            (1..=self.buildings).filter(|number| is_of_shard(*number)).map(|number| self.seed + number - 1)
        {
            for (kind, things) in
                self.kind.iter().flat_map(|kind| self.habits.iter().map(move |things| (kind, things)))
            {
                for (share, strategy) in self
                    .duty
                    .iter()
                    .flat_map(|share| self.strategy.iter().map(move |strategy| (share, strategy)))
                {
                    runs.extend(Run::all(*kind, *things, *share, seed, self.days, strategy, &self.length));
                }
            }
        }
        runs
    }
}

fn main() -> anyhow::Result<()> {
    let options = Options::parse();
    if !options.merge.is_empty() {
        let mut rows = study::merged(&options.merge)?;
        cells::sort(&mut rows);
        let Some(path) = &options.page else {
            tables::print(&rows);
            return Ok(());
        };
        return study::rewrite(path, |text| page::rewritten(text, &rows));
    }
    let runs = options.runs();
    ensure!(!runs.is_empty(), "there is nothing to compute");
    let is_recorded = options.habits.contains(&Things::Recorded);
    ensure!(
        is_recorded != options.doors.is_empty(),
        "--habits recorded needs --doors and --others, and only it needs them"
    );
    ensure!(
        !(is_recorded && options.strategy.iter().any(|strategy| strategy == BOUND)),
        "recorded things have no habits that a bound could know: leave out one of --habits recorded and --strategy {BOUND}"
    );
    let recorded = Recorded::read(&options.doors, &options.others, options.days)?;
    let study = Study::open(options.csv.as_deref())?;
    let mut rows = study.complete(&runs, |run: &Run| Ok(run.row(&recorded)))?;
    cells::sort(&mut rows);
    tables::print(&rows);
    Ok(())
}

//! Which strategy keeps a map fresh in buildings where a robot must also drive? Generated physics worlds with a calendar.
//!
//! ```text
//! cargo run -p curious-reports --example physics_patrols -- --csv physics.csv
//! cargo run -p curious-reports --example physics_patrols -- --csv a.csv --shard 1/2           # and 2/2
//! cargo run -p curious-reports --example physics_patrols -- --merge a.csv b.csv
//! cargo run -p curious-reports --example physics_patrols -- --merge physics.csv --page docs/strategies.md
//! ```
//!
//! Every strategy has the same buildings, and the same changes in them. The measures are those of `four_rooms` (`scheduled` in
//! `summary.json`): the Brier score of the predicted map over all things with a schedule, every minute, in view or not; the delays of
//! changes that last an hour or more, by belief; what users lose per trip, and the trips that they do not make. Ratios are those of
//! means, with the p-value of the paired t test of the differences.
//!
//! A file of `--csv` gets a line per run as soon as it ends, and a study that was stopped goes on where it was. A run of a week takes
//! half a minute with 1 % of the time on patrol, and minutes with 5 %.

#[path = "physics_patrols/rows.rs"]
mod rows;
#[path = "study/rows.rs"]
mod study;
#[path = "physics_patrols/table.rs"]
mod table;

use agent::Policy;
use anyhow::ensure;
use clap::Parser;
use days::Kind;
use reports::shards::Shard;
use rows::{Row, Run};
use std::path::PathBuf;
use study::Study;

#[derive(Parser)]
struct Options {
    /// Kinds of buildings: home, office, warehouse, clinic
    #[arg(long, default_values = ["home", "office"])]
    kind: Vec<Kind>,
    /// The number of buildings of each kind
    #[arg(long, default_value_t = 10)]
    buildings: u64,
    /// The seed of the first building
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The share of the time that the robot can be on patrol, above 0, at most 1
    #[arg(long, default_values_t = [0.05, 0.01], value_parser = share)]
    duty: Vec<f64>,
    /// How long the robot can be on patrol with a full battery, s: a robot that charges for hours looks rarely
    #[arg(long, default_value_t = 300.0, value_parser = battery_s)]
    battery: f64,
    /// Strategies, as of `four_rooms`
    #[arg(long, default_values = ["curious", "recency", "fresh-map"])]
    strategy: Vec<Policy>,
    /// Simulated days
    #[arg(long, default_value_t = 7)]
    days: u32,
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

fn battery_s(word: &str) -> Result<f64, String> {
    let value = word.parse::<f64>().ok().filter(|value| (60.0..=1e6).contains(value));
    value.ok_or_else(|| "expected a number from 60 to 1000000".to_owned())
}

impl Options {
    /// All runs of the study, or of its shard, building by building.
    fn runs(&self) -> Vec<Run> {
        let mut runs = Vec::new();
        let of_shard =
            (1..=self.buildings).filter(|number| self.shard.is_none_or(|shard| shard.has(*number)));
        for (seed, kind) in of_shard.flat_map(|number| self.kind.iter().map(move |kind| (number - 1, *kind)))
        {
            for (share, strategy) in
                self.duty.iter().flat_map(|share| self.strategy.iter().map(move |strategy| (share, strategy)))
            {
                let (share, strategy, seed) = (*share, strategy.clone(), self.seed + seed);
                runs.push(Run { kind, share, battery_s: self.battery, days: self.days, seed, strategy });
            }
        }
        runs
    }
}

fn main() -> anyhow::Result<()> {
    let options = Options::parse();
    if !options.merge.is_empty() {
        let rows: Vec<Row> = study::merged(&options.merge)?;
        let Some(path) = &options.page else {
            print!("{}", table::table(&rows).map_err(anyhow::Error::msg)?);
            return Ok(());
        };
        return study::rewrite(path, |page| table::rewritten(page, &rows));
    }
    let runs = options.runs();
    ensure!(!runs.is_empty(), "there is nothing to compute");
    let rows = Study::open(options.csv.as_deref())?.complete(&runs, Run::row)?;
    print!("{}", table::table(&rows).map_err(anyhow::Error::msg)?);
    Ok(())
}

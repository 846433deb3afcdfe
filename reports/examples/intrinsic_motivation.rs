//! Intrinsically motivated reinforcement learning against the strategies, in generated grid worlds.
//!
//! ```text
//! cargo run -p curious-reports --example intrinsic_motivation -- --csv study.csv
//! cargo run -p curious-reports --example intrinsic_motivation -- --shard 1/2 --csv 1.csv             # and 2/2
//! cargo run -p curious-reports --example intrinsic_motivation -- --merge 1.csv 2.csv
//! cargo run -p curious-reports --example intrinsic_motivation -- --merge study.csv --page docs/strategies.md
//! ```
//!
//! `cells-MOTIVE` is tabular Q-learning over the cells of the robot: it chooses single steps, and learns anew in every world.
//! `goals-MOTIVE` is SARSA with tile coding over goals: it sees the same six features of every patch in every world, so that it
//! can learn in other worlds before (`--experience`). Both go on learning in the world in which they are measured. All robots have
//! the same sensor, mapper and, but for the first learners, the same controller.
//!
//! A file of `--csv` gets a line per run as soon as it ends. A study that was stopped goes on where it was.

#[path = "intrinsic_motivation/cells.rs"]
mod cells;
#[path = "intrinsic_motivation/distillation.rs"]
mod distillation;
#[path = "intrinsic_motivation/forward_model.rs"]
mod forward_model;
#[path = "intrinsic_motivation/goals.rs"]
mod goals;
#[path = "intrinsic_motivation/life.rs"]
mod life;
#[path = "intrinsic_motivation/motives.rs"]
mod motives;
#[path = "intrinsic_motivation/rows.rs"]
mod rows;
#[path = "intrinsic_motivation/runs.rs"]
mod runs;
#[path = "study/rows.rs"]
mod study;
#[path = "intrinsic_motivation/tables.rs"]
mod tables;
#[cfg(test)]
#[path = "intrinsic_motivation/tests.rs"]
mod tests;
#[path = "intrinsic_motivation/tiles.rs"]
mod tiles;
#[path = "intrinsic_motivation/view.rs"]
mod view;

use anyhow::ensure;
use cells::CellSettings;
use clap::Parser;
use goals::{GoalSettings, Learned};
use rayon::prelude::*;
use reports::shards::Shard;
use rows::Row;
use runs::{Run, Tuned, can_be_trained, learners, train};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use study::Study;

/// A learner that was trained elsewhere is measured in lives of at most this number of steps.
const TRAINED_STEPS: u64 = 20_000;

#[derive(Parser)]
struct Options {
    /// The number of worlds
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u64).range(1..=50_000))]
    worlds: u64,
    /// The seed of the first world. Settings were tuned in worlds of seeds from 100000 on, and learners are trained in worlds of
    /// seeds from 200000 on
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The length of a life, steps; lives of learners that were trained elsewhere end at 20,000
    #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    steps: u64,
    /// A strategy or a learner [default: all]
    #[arg(long, value_parser = learner)]
    learner: Vec<String>,
    /// The steps of training in other worlds, of learners over goals
    #[arg(long, default_values_t = [0, 10_000, 100_000], value_parser = clap::value_parser!(u64).range(0..=100_000_000))]
    experience: Vec<u64>,
    /// The number of independent training runs: world i is that of training run i modulo this number
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u64).range(1..=1000))]
    training_runs: u64,
    /// The estimator of the rates
    #[arg(long, default_values = ["two-state-gaps"], value_parser = ["two-state-gaps", "paper"])]
    estimator: Vec<String>,
    /// Step size, discount, random share and first value of learners over cells, and the number of steps that they learn again at every step
    #[arg(long, num_args = 5)]
    cells: Option<Vec<f64>>,
    /// Step size, discount, random share and first value of learners over goals
    #[arg(long, num_args = 4)]
    goals: Option<Vec<f64>>,
    /// Computes a part: K/N has the worlds whose number, from 1 on, is K, K + N, …
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

fn learner(word: &str) -> Result<String, String> {
    let all = learners();
    if all.iter().any(|name| name == word) {
        Ok(word.to_owned())
    } else {
        Err(format!("there are {}", all.join(", ")))
    }
}

/// The key of a training: motive, training run and estimator.
type Training = (String, u64, String);

impl Options {
    fn tuned(&self) -> Tuned {
        let mut tuned = Tuned::default();
        if let Some(&[alpha, gamma, epsilon, optimism, replays]) = self.cells.as_deref() {
            tuned.cells = CellSettings { alpha, gamma, epsilon, optimism, replays: replays as usize };
        }
        if let Some(&[alpha, gamma, epsilon, optimism]) = self.goals.as_deref() {
            tuned.goals = GoalSettings { alpha, gamma, epsilon, optimism };
        }
        tuned
    }

    /// All runs of the study, or of its shard, world by world.
    fn runs(&self) -> Vec<Run> {
        let is_of_shard = |number: u64| self.shard.is_none_or(|shard| shard.has(number));
        let all = if self.learner.is_empty() { learners() } else { self.learner.clone() };
        let mut runs = Vec::new();
        for seed in
            (1..=self.worlds).filter(|number| is_of_shard(*number)).map(|number| self.seed + number - 1)
        {
            for (estimator, learner) in
                self.estimator.iter().flat_map(|name| all.iter().map(move |learner| (name, learner)))
            {
                let trained = can_be_trained(learner);
                for &experience in self.experience.iter().filter(|steps| trained || **steps == 0) {
                    let steps = if experience > 0 { self.steps.min(TRAINED_STEPS) } else { self.steps };
                    let (learner, estimator) = (learner.clone(), estimator.clone());
                    runs.push(Run { learner, experience, estimator, steps, seed });
                }
            }
        }
        runs
    }

    fn training(&self, run: &Run) -> Option<Training> {
        let motive = run.goal_motive().filter(|_| run.experience > 0)?;
        Some((motive.to_owned(), run.seed % self.training_runs, run.estimator.clone()))
    }

    /// What was learned in all trainings that the runs need.
    fn train(&self, runs: &[&Run]) -> anyhow::Result<BTreeMap<Training, Vec<(u64, Learned)>>> {
        let mut needed: BTreeMap<Training, BTreeSet<u64>> = BTreeMap::new();
        for run in runs {
            if let Some(training) = self.training(run) {
                needed.entry(training).or_default().insert(run.experience);
            }
        }
        let settings = self.tuned().goals;
        let learn = |(training, experiences): (Training, BTreeSet<u64>)| {
            let experiences: Vec<u64> = experiences.into_iter().collect();
            let learned = train(&training.0, training.1, &experiences, &training.2, settings)?;
            Ok((training, learned))
        };
        needed.into_par_iter().map(learn).collect()
    }
}

fn main() -> anyhow::Result<()> {
    let options = Options::parse();
    if !options.merge.is_empty() {
        let rows = study::merged(&options.merge)?;
        let Some(path) = &options.page else {
            tables::print(rows);
            return Ok(());
        };
        return study::rewrite(path, |page| tables::rewritten(page, rows));
    }
    let runs = options.runs();
    ensure!(!runs.is_empty(), "there is nothing to compute");
    let study = Study::open(options.csv.as_deref())?;
    let trained = options.train(&study.missing(&runs))?;
    let rows = study.complete(&runs, |run| {
        let learned = options.training(run).and_then(|training| trained.get(&training));
        let learned = learned.and_then(|all| all.iter().find(|(steps, _)| *steps == run.experience));
        let outcome = run.outcome(options.tuned(), learned.map(|(_, learned)| learned))?;
        Ok(Row { run: run.clone(), outcome })
    })?;
    tables::print(rows);
    Ok(())
}

//! Where should a robot look, to keep its map fresh? Strategies in generated buildings with a calendar.
//!
//! ```text
//! cargo run -p curious-reports --example patrols -- --kind home --kind office --buildings 100 --duty 1 --duty 0.05 --duty 0.01
//! ```
//!
//! Every strategy has the same buildings, and the same changes in them. A column `÷ X` is the Brier score divided by that of
//! X (ratio of the means), with the p-value of the paired t test of the differences. Delays are those of changes that last an
//! hour or more, by belief: median and 95 % point, each the mean over the buildings, and the share that was missed.
//!
//! A second table has the lower bound of the Brier score of all strategies (B ÷ bound: ratio of the means), and the freshness
//! regret of each building: (B − bound) ÷ (B without looks − bound), 0 at the bound and 1 without any use of looks. Its columns
//! `÷ X` are ratios of mean regrets, with the p-value of the paired t test. `--csv FILE` writes all runs: a study can be
//! computed in parts by `--seed` and `--buildings`.

#[path = "patrols/regret.rs"]
mod regret;

use clap::Parser;
use days::{Building, Duty, Kind, Patrol, Plan, STEP_S, Totals};
use evaluation::metrics::{Freshness, FreshnessScores};
use rayon::prelude::*;
use regret::{Scores, bounds};
use std::path::PathBuf;
use std::time::Instant;

const DAY_STEPS: f64 = 86_400.0 / STEP_S;

#[derive(Parser)]
struct Options {
    /// Kinds of buildings: home, office, warehouse, clinic
    #[arg(long, default_values = ["home", "office"])]
    kind: Vec<Kind>,
    /// The number of buildings of each kind
    #[arg(long, default_value_t = 100)]
    buildings: u64,
    /// The seed of the first building; strategies were tuned on seeds from 100000 on
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// The share of the time that the robot can be on patrol, above 0, at most 1
    #[arg(long, default_values_t = [1.0, 0.05, 0.01], value_parser = share)]
    duty: Vec<f64>,
    /// Simulated days
    #[arg(long, default_value_t = 7.0, value_parser = positive)]
    days: f64,
    /// The length of a patrol of the strategies that do not choose it, min: at most 30. The mean is printed for each length
    #[arg(long, default_values_t = [30.0], value_parser = minutes)]
    length: Vec<f64>,
    /// The robot does not know the habits of the things, and learns them from its looks
    #[arg(long)]
    learned: bool,
    /// Leaves out the lower bound of all strategies, which takes most of the time
    #[arg(long)]
    without_bound: bool,
    /// A table of all runs: a line per building, share of the time and strategy
    #[arg(long)]
    csv: Option<PathBuf>,
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

/// A run of a strategy in a building.
struct Run {
    scores: FreshnessScores,
    totals: Totals,
}

fn main() -> std::io::Result<()> {
    let options = Options::parse();
    let mut plans = vec![("no looks".to_owned(), Plan::Never)];
    for minutes in &options.length {
        let length = (60.0 * minutes / STEP_S) as usize;
        let name = |name: &str| {
            if options.length.len() == 1 { name.to_owned() } else { format!("{name} {minutes}") }
        };
        plans.push((name("curious"), Plan::Curious(length)));
        plans.push((name("round"), Plan::Round(length)));
        plans.push((name("coverage"), Plan::Coverage(length)));
    }
    plans.push(("gain".to_owned(), Plan::Gain));
    let mut all = Vec::new();
    for kind in &options.kind {
        for duty in &options.duty {
            all.push(table(*kind, Duty::share(*duty), *duty, &plans, &options));
        }
    }
    if let Some(path) = &options.csv {
        regret::write(path, &all)?;
    }
    Ok(())
}

fn table(kind: Kind, duty: Duty, share: f64, plans: &[(String, Plan)], options: &Options) -> Scores {
    let began = Instant::now();
    let seeds: Vec<u64> = (options.seed..options.seed + options.buildings).collect();
    let steps = (options.days * DAY_STEPS) as usize;
    let runs: Vec<Vec<Run>> = seeds
        .par_iter()
        .map(|seed| {
            let building = Building::generate(kind, *seed);
            plans.iter().map(|(_, plan)| run(&building, duty, *plan, *seed, steps, options.learned)).collect()
        })
        .collect();
    let real = began.elapsed().as_secs_f64();
    let simulated = (seeds.len() * plans.len() * steps) as f64 * STEP_S;
    let name = Kind::ALL.iter().find(|(_, other)| *other == kind).map_or("", |(name, _)| name);
    println!(
        "\n{name}, {} buildings from seed {}, {} days, patrol {} % of the time, habits {}, {:.0} × real time",
        seeds.len(),
        options.seed,
        options.days,
        100.0 * share,
        if options.learned { "learned" } else { "known" },
        simulated / real
    );
    println!(
        "{:<14} {:>8} {:>8} {:>9} {:>8} {:>9} {:>7} {:>7} {:>7} {:>8} {:>7}",
        "strategy", "Brier", "÷curious", "p", "÷round", "p", "median", "95 %", "missed", "driving", "closed"
    );
    let column = |plan: usize, value: fn(&Run) -> f64| {
        let values = runs.iter().map(move |runs| value(&runs[plan])).filter(|value| value.is_finite());
        let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
        sum / f64::from(count)
    };
    let brier = |run: &Run| run.scores.brier;
    let best = |word: &str| {
        let named = (0..plans.len()).filter(|plan| plans[*plan].0.starts_with(word));
        named.min_by(|a, b| column(*a, brier).total_cmp(&column(*b, brier))).unwrap_or(0)
    };
    let (curious, round) = (best("curious"), best("round"));
    for (plan, (name, _)) in plans.iter().enumerate() {
        let against = |other: usize| {
            let ratio = column(plan, brier) / column(other, brier);
            let differences = runs.iter().map(|runs| brier(&runs[plan]) - brier(&runs[other]));
            (ratio, reports::paired_test(differences).p_value)
        };
        let ((to_curious, p_curious), (to_round, p_round)) = (against(curious), against(round));
        println!(
            "{name:<14} {:>8.4} {to_curious:>8.3} {p_curious:>9.1e} {to_round:>8.3} {p_round:>9.1e} {:>6.0}m {:>6.0}m {:>6.1}% {:>7.2}% {:>6.1}%",
            column(plan, brier),
            column(plan, |run| run.scores.detection_delay_s[0]) / 60.0,
            column(plan, |run| run.scores.detection_delay_s[1]) / 60.0,
            100.0 * column(plan, |run| run.scores.missed),
            100.0 * column(plan, |run| run.totals.patrol_steps as f64 / run.totals.steps as f64),
            100.0 * column(plan, |run| run.totals.closed as f64 / run.totals.looks.max(1) as f64),
        );
    }
    let scores = Scores {
        place: name.to_owned(),
        share,
        bounds: if options.without_bound { Vec::new() } else { bounds(kind, duty, &seeds, steps) },
        briers: (0..plans.len()).map(|plan| runs.iter().map(|runs| brier(&runs[plan])).collect()).collect(),
        plans: plans.iter().map(|plan| plan.0.clone()).collect(),
        seeds,
    };
    scores.print([curious, round]);
    scores
}

fn run(building: &Building, duty: Duty, plan: Plan, seed: u64, steps: usize, learned: bool) -> Run {
    let start = if learned { Patrol::learning } else { Patrol::new };
    let mut strategy = plan.strategy(building, duty);
    let mut freshness = Freshness::new(STEP_S);
    let totals = start(building, duty, seed)
        .run(strategy.as_mut(), steps, |predicted, is_blocked| freshness.add(predicted, is_blocked));
    Run { scores: freshness.scores(), totals }
}

//! Where should a robot look, to keep its map fresh? Strategies in generated buildings with a calendar.
//!
//! ```text
//! cargo run -p curious-studies --bin patrols -- --kind home --kind office --buildings 50 > rows.csv
//! ```
//!
//! Every strategy has the same buildings, and the same changes in them. Delays are those of changes that last an hour or more,
//! by belief: median and 95 % point, and the share that was missed. *Lost* is the time that users lose per trip between two
//! places, since doors that the map believed open are closed, and *not made* the share of the possible trips for which the map
//! showed no open way. The strategy `bound` has the lower bound of the Brier score of all strategies, and no other measure.
//!
//! A row is printed as soon as its run ends; at the end, the mean Brier scores go to the other output.

use clap::Parser;
use evaluation::metrics::Freshness;
use studies::freshness_bound::building::{BoundSettings, BuildingBound};
use studies::rows::{Score, compute, means};
use studies::{Building, Duty, Habits, Kind, Patrol, Plan, Routes, STEP_S, UserRegret};

const STRATEGIES: [&str; 6] = ["no-looks", "curious", "round", "coverage", "gain", BOUND];
const BOUND: &str = "bound";
const DAY_STEPS: f64 = 86_400.0 / STEP_S;
/// The number of steps between two trips of users: fifty minutes.
const TRIP_STEPS: usize = 300;

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
    /// The shares of the time that the robot can be on patrol, above 0, at most 1
    #[arg(long, default_values_t = [1.0, 0.05, 0.01])]
    duty: Vec<f64>,
    /// Strategies: all but the bound, which takes most of the time
    #[arg(long, default_values = &STRATEGIES[..5], value_parser = STRATEGIES)]
    strategy: Vec<String>,
    /// Simulated days
    #[arg(long, default_value_t = 7.0)]
    days: f64,
    /// The length of a patrol of the strategies that do not choose it, min [default: 2.5 in homes, otherwise 3.5]
    #[arg(long)]
    length: Option<f64>,
}

/// What is computed.
struct Run {
    kind: Kind,
    habits: Habits,
    share: f64,
    seed: u64,
    strategy: String,
}

/// A run and its results.
#[derive(serde::Serialize)]
struct Row {
    kind: &'static str,
    habits: &'static str,
    share: f64,
    days: f64,
    seed: u64,
    strategy: String,
    length_min: Option<f64>,
    brier: f64,
    median_min: f64,
    delay95_min: f64,
    missed: f64,
    patrol: f64,
    /// The share of the looks that a closed door prevented.
    closed: f64,
    lost_s: f64,
    not_made: f64,
}

impl Options {
    /// All runs, building by building.
    fn runs(&self) -> Vec<Run> {
        let mut runs = Vec::new();
        for seed in self.seed..self.seed + self.buildings {
            for (kind, habits) in self.kind.iter().flat_map(|kind| self.habits.iter().map(move |h| (kind, h)))
            {
                for (share, strategy) in
                    self.duty.iter().flat_map(|d| self.strategy.iter().map(move |s| (d, s)))
                {
                    let (kind, habits, strategy) = (*kind, *habits, strategy.clone());
                    runs.push(Run { kind, habits, share: *share, seed, strategy });
                }
            }
        }
        runs
    }

    fn row(&self, run: &Run) -> Row {
        let building = Building::generate(run.kind, run.seed);
        let (duty, steps) = (Duty::share(run.share), (self.days * DAY_STEPS) as usize);
        let has_length = run.share < 1.0 && ["curious", "round", "coverage"].contains(&run.strategy.as_str());
        let usual_min = if run.kind == Kind::Home { 2.5 } else { 3.5 };
        let length_min = has_length.then_some(self.length.unwrap_or(usual_min));
        let mut row = Row {
            kind: run.kind.name(),
            habits: run.habits.name(),
            share: run.share,
            days: self.days,
            seed: run.seed,
            strategy: run.strategy.clone(),
            length_min,
            brier: f64::NAN,
            median_min: f64::NAN,
            delay95_min: f64::NAN,
            missed: f64::NAN,
            patrol: f64::NAN,
            closed: f64::NAN,
            lost_s: f64::NAN,
            not_made: f64::NAN,
        };
        if run.strategy == BOUND {
            let settings = BoundSettings::of(&building, duty);
            row.brier = BuildingBound::new(&building, duty, steps, settings).brier(run.seed);
            return row;
        }
        let length = length_min.map_or(1, |minutes| (60.0 * minutes / STEP_S) as usize);
        let plan = match run.strategy.as_str() {
            "curious" => Plan::Curious(length),
            "round" => Plan::Round(length),
            "coverage" => Plan::Coverage(length),
            "gain" => Plan::Gain,
            _ => Plan::Never,
        };
        let (mut freshness, mut users) = (Freshness::new(STEP_S), UserRegret::default());
        let (routes, mut step) = (Routes::of_building(&building), 0);
        let mut patrol = Patrol::with(&building, duty, run.habits, run.seed);
        let totals = patrol.run(plan.strategy(&building, duty).as_mut(), steps, |predicted, is_blocked| {
            freshness.add(predicted, is_blocked);
            step += 1;
            if step % TRIP_STEPS == 0 {
                users.add(&routes, predicted, is_blocked);
            }
        });
        let scores = freshness.scores();
        row.brier = scores.brier;
        [row.median_min, row.delay95_min] = scores.detection_delay_s.map(|delay_s| delay_s / 60.0);
        row.missed = scores.missed;
        row.patrol = totals.patrol_steps as f64 / totals.steps as f64;
        row.closed = totals.closed as f64 / totals.looks.max(1) as f64;
        (row.lost_s, row.not_made) = (users.lost_s(), users.not_made());
        row
    }
}

fn main() -> anyhow::Result<()> {
    let options = Options::parse();
    let rows = compute(&options.runs(), |run| Ok(options.row(run)))?;
    let score = |row: &Row| Score {
        group: format!("{}, habits {}, on patrol {} % of the time", row.kind, row.habits, 100.0 * row.share),
        strategy: row.strategy.clone(),
        seed: row.seed,
        brier: row.brier,
    };
    eprint!("{}", means(&rows.iter().map(score).collect::<Vec<_>>()));
    Ok(())
}

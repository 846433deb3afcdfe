//! Which strategy keeps a map fresh in buildings where a robot must also drive? Generated physics worlds with a calendar.
//!
//! ```text
//! cargo run -p curious-studies --bin physics_patrols -- --duty 0.01 > rows.csv
//! ```
//!
//! Every strategy has the same buildings, and the same changes in them. The measures are those of `four_rooms` (`scheduled` in
//! `summary.json`): the Brier score of the predicted map over all things with a schedule, every minute, in view or not; the delays of
//! changes that last an hour or more, by belief.
//!
//! A run of a week takes half a minute with 1 % of the time on patrol, and minutes with 5 %. A row is printed as soon as its run
//! ends; at the end, the mean Brier scores go to the other output.

use agent::Policy;
use anyhow::Context;
use calendar::Kind;
use clap::Parser;
use evaluation::physics_trial::{PhysicsTrial, day, in_own_frame, settings};
use robot::PatrolDay;
use sim::physics::{PatrolDaySpec, WorldSpec};
use studies::rows::{Score, compute, means};

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
    /// The shares of the time that the robot can be on patrol, above 0, at most 1
    #[arg(long, default_values_t = [0.05, 0.01])]
    duty: Vec<f64>,
    /// How long the robot can be on patrol with a full battery, s: a robot that charges for hours looks rarely
    #[arg(long, default_value_t = 300.0)]
    battery: f64,
    /// Strategies, as of `four_rooms`
    #[arg(long, default_values = ["curious", "recency", "fresh-map"])]
    strategy: Vec<Policy>,
    /// Simulated days
    #[arg(long, default_value_t = 7)]
    days: u32,
}

/// What is computed.
struct Run {
    kind: Kind,
    share: f64,
    seed: u64,
    strategy: Policy,
}

/// A run and its results: delays in minutes; shares of the lasting changes that were missed, and of the time on patrol; how often the battery was flat away from the dock; contacts by the robot's own motion.
#[derive(serde::Serialize)]
struct Row {
    kind: &'static str,
    share: f64,
    battery_s: f64,
    days: u32,
    seed: u64,
    strategy: String,
    brier: f64,
    by_nominal: Option<f64>,
    median_min: f64,
    delay95_min: f64,
    missed: f64,
    patrol: f64,
    flat: u32,
    contacts: usize,
}

impl Options {
    /// All runs, building by building.
    fn runs(&self) -> Vec<Run> {
        let mut runs = Vec::new();
        for seed in self.seed..self.seed + self.buildings {
            for (kind, share) in
                self.kind.iter().flat_map(|kind| self.duty.iter().map(move |share| (kind, share)))
            {
                let run =
                    |strategy: &Policy| Run { kind: *kind, share: *share, seed, strategy: strategy.clone() };
                runs.extend(self.strategy.iter().map(run));
            }
        }
        runs
    }

    fn row(&self, run: &Run) -> anyhow::Result<Row> {
        let &Run { kind, share, seed, ref strategy } = run;
        let patrol = PatrolDaySpec { battery_s: self.battery, ..PatrolDaySpec::of_share(share) };
        let spec = WorldSpec::generate_calendar(kind, seed).with_patrol(patrol);
        let settings = settings(&spec)?;
        let own = in_own_frame(&settings, &spec, seed);
        let day = day(own.as_ref().map_or(&spec, |(spec, _)| spec)).context("the robot has no patrol")?;
        let pilot = PatrolDay::new(settings.pilot(settings.agent(strategy, seed)?, seed)?, day);
        let mut trial = PhysicsTrial::new(&spec, seed, &settings, None, pilot)?.on_battery();
        let end_s = f64::from(self.days) * 86_400.0;
        trial.run(end_s)?;
        let results = trial.results();
        let scheduled = results.scheduled.context("nothing in the world has a schedule")?.fresh;
        let day = results.day.context("the robot has no day")?;
        let [median_min, delay95_min] = scheduled.detection_delay_s.map(|delay_s| delay_s / 60.0);
        Ok(Row {
            kind: kind.name(),
            share,
            battery_s: self.battery,
            days: self.days,
            seed,
            strategy: strategy.name().to_owned(),
            brier: scheduled.brier,
            by_nominal: results.known_things.and_then(|known| Some(known.all.now?.by_nominal)),
            median_min,
            delay95_min,
            missed: scheduled.missed,
            patrol: day.patrol_s / end_s,
            flat: day.flat,
            contacts: results.contacts.own_motion,
        })
    }
}

fn main() -> anyhow::Result<()> {
    let options = Options::parse();
    let rows = compute(&options.runs(), |run| options.row(run))?;
    let score = |row: &Row| Score {
        group: format!("{}, on patrol {} % of the time", row.kind, 100.0 * row.share),
        strategy: row.strategy.clone(),
        seed: row.seed,
        brier: row.brier,
    };
    eprint!("{}", means(&rows.iter().map(score).collect::<Vec<_>>()));
    Ok(())
}

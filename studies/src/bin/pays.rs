//! Where does curiosity pay? Buildings of rooms in which things come and go: by how much the predicted map is better if the robot
//! chooses where to look, than if it looks everywhere in turn.
//!
//! ```text
//! cargo run -p curious-studies --bin pays -- predict > predicted.csv
//! cargo run -p curious-studies --bin pays -- measure > measured.csv
//! cargo run -p curious-studies --bin pays -- compare predicted.csv measured.csv
//! ```
//!
//! `predict` runs in an event simulator of views and travel, `measure` in a physics world with a laser; both have the same places,
//! changes, maps and strategies. Options that are repeated multiply. A row is printed as soon as its run ends; at the end, the table goes
//! to the other output: for every setting the Brier score of “the thing is there” over all things at all times after the first hour,
//! divided by that of the best of recency, curious and coverage (one for all places), ± a standard error.

use anyhow::{Context, bail};
use clap::{Args, Parser, Subcommand};
use std::path::{Path, PathBuf};
use studies::pays::{Outcome, Place, Row, Setting, compare, figure, measure, predict, table};
use studies::rows::compute;

#[derive(Parser)]
struct Options {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// In the event simulator
    Predict(Runs),
    /// In the physics world
    Measure(Runs),
    /// Print what was predicted beside what was measured
    Compare {
        /// The rows of `predict`
        predicted: PathBuf,
        /// The rows of `measure`
        measured: PathBuf,
    },
    /// Print a figure as SVG: what was predicted, and what was measured
    Figure {
        /// The rows of `predict`
        predicted: PathBuf,
        /// The rows of `measure`
        measured: PathBuf,
    },
    /// Print a place as a world file for `four_rooms` and `house_trials`
    World {
        /// The seed of the place
        #[arg(long, default_value_t = 0)]
        seed: u64,
        #[command(flatten)]
        kinds: Kinds,
    },
}

#[derive(Args)]
struct Kinds {
    /// The rooms along each side, and the side of a room, m, as 6x4; with 4 m at a multiple of 4
    #[arg(long, default_values = ["6x4"])]
    rooms: Vec<String>,
    /// The range of the laser, m
    #[arg(long, default_values_t = [3.0])]
    laser: Vec<f64>,
    /// The things in a part of 4 × 4 m that has any, 1 to 4; `3a`: three with the same rates
    #[arg(long, default_values = ["1"])]
    things: Vec<String>,
    /// The standard deviation of the logarithm of the mean stays
    #[arg(long, default_values_t = [1.5])]
    spread: Vec<f64>,
    /// The shares of the time that the robot is on patrol; 1: always moving
    #[arg(long, default_values_t = [1.0])]
    duty: Vec<f64>,
}

#[derive(Args)]
struct Runs {
    #[command(flatten)]
    kinds: Kinds,
    /// The number of places of each setting
    #[arg(long, default_value_t = 30)]
    places: u64,
    /// The seed of the first place
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Strategies: those of `four_rooms`, and `oracle`, which knows the true rates
    #[arg(long, default_values = ["recency", "curious", "coverage", "fresh-map", "oracle"])]
    strategy: Vec<String>,
    /// Simulated hours; the first one is left out
    #[arg(long, default_value_t = 6.0)]
    hours: f64,
}

impl Kinds {
    fn settings(&self) -> anyhow::Result<Vec<Setting>> {
        let mut settings = Vec::new();
        let check = |name: &str, values: &[f64], [least, most]: [f64; 2]| {
            let is_within = values.iter().all(|value| (least..=most).contains(value));
            anyhow::ensure!(is_within, "--{name}: expected numbers from {least} to {most}");
            Ok(())
        };
        check("laser", &self.laser, [1.0, 50.0])?;
        check("spread", &self.spread, [0.0, 5.0])?;
        check("duty", &self.duty, [0.001, 1.0])?;
        for text in &self.rooms {
            let parts = text
                .split_once('x')
                .and_then(|(rooms, side)| Some((rooms.parse().ok()?, side.parse().ok()?)));
            let Some((rooms, side_m)) = parts.filter(|(rooms, side): &(usize, f64)| {
                (1..=20).contains(rooms) && (4.0..=40.0).contains(side) && (side / 4.0).fract() == 0.0
            }) else {
                bail!(
                    "--rooms {text}: expected 1 to 20 rooms along a side and their side in m, a multiple of 4, such as 6x4"
                );
            };
            for things in &self.things {
                let count = things.trim_end_matches('a');
                let count = count.parse().ok().filter(|count| (1..=4).contains(count));
                let count = count.with_context(|| format!("--things {things}: expected 1 to 4, or 3a"))?;
                let alike = things.ends_with('a');
                for &laser_m in &self.laser {
                    for &spread in &self.spread {
                        let of = |duty: &f64| Setting {
                            rooms,
                            side_m,
                            laser_m,
                            things: count,
                            alike,
                            spread,
                            duty: *duty,
                        };
                        settings.extend(self.duty.iter().map(of));
                    }
                }
            }
        }
        Ok(settings)
    }
}

impl Runs {
    fn run(
        &self,
        run: impl Fn(&Place, &str, u64, f64) -> anyhow::Result<Outcome> + Sync,
    ) -> anyhow::Result<Vec<Row>> {
        let settings = self.kinds.settings()?;
        anyhow::ensure!(
            self.hours > 1.0 && self.hours <= 1000.0,
            "--hours: expected more than 1: the first is left out"
        );
        let seeds = self.seed..self.seed + self.places;
        let jobs: Vec<(Setting, u64, &String)> = seeds
            .flat_map(|seed| settings.iter().map(move |setting| (*setting, seed)))
            .flat_map(|(setting, seed)| self.strategy.iter().map(move |strategy| (setting, seed, strategy)))
            .collect();
        compute(&jobs, |(setting, seed, strategy)| {
            let Setting { rooms, side_m, laser_m, things, alike, spread, duty } = *setting;
            let Outcome { brier, way_m } =
                run(&Place::generate(*setting, *seed), strategy, *seed, self.hours)?;
            let (seed, strategy, hours) = (*seed, (*strategy).clone(), self.hours);
            Ok(Row {
                rooms,
                side_m,
                laser_m,
                things,
                alike,
                spread,
                duty,
                hours,
                seed,
                strategy,
                brier,
                way_m,
            })
        })
    }
}

fn read(path: &Path) -> anyhow::Result<Vec<Row>> {
    let rows = csv::Reader::from_path(path).and_then(|mut rows| rows.deserialize().collect());
    rows.with_context(|| format!("{}: no rows of `pays`", path.display()))
}

fn main() -> anyhow::Result<()> {
    match Options::parse().command {
        Command::Predict(runs) => eprint!("{}", table(&runs.run(predict)?)),
        Command::Measure(runs) => eprint!("{}", table(&runs.run(measure)?)),
        Command::Compare { predicted, measured } => {
            print!("{}", compare(&read(&predicted)?, &read(&measured)?))
        }
        Command::Figure { predicted, measured } => {
            print!("{}", figure(&read(&predicted)?, &read(&measured)?).map_err(anyhow::Error::msg)?);
        }
        Command::World { seed, kinds } => {
            let setting = *kinds.settings()?.first().context("no setting")?;
            let world = Place::generate(setting, seed).world()?;
            print!("{}", worldfile::physics::to_toml(&world).context("no file can hold this world")?);
        }
    }
    Ok(())
}

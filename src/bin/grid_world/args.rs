//! The command line.

use agent::Reward;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Parser, ValueEnum};
use evaluation::trials::TrialStrategy;
use mapper::Estimator;
use std::path::PathBuf;

/// Compares ways to explore in grid worlds with moving blocks: the paper's Figure 3, with honest
/// statistics.
///
/// Without any option: the paper's world, its learner (curious) against each of its strategies alone
/// (recency, poisson) and two baselines (random, coin), five trials of 20,000 steps each. What comes
/// out lies in the folder grid_world_out: the curves as a picture (figure3.svg, figure3.png), every
/// number (report.json), every trial (trials.csv). The table printed at the end tells who learned the
/// rates of change best, and whether that could be luck.
///
/// Options that can be given several times multiply: 2 worlds, 2 estimators, 3 strategies and 10
/// trials are 120 lives.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "grid_world",
    version,
    max_term_width = 100,
    after_help = "Examples:\n  \
        grid_world --trials 100                                  the same with power\n  \
        grid_world --generate 50 --trials 2 --strategy curious --strategy progress\n  \
        grid_world --world my_world.toml --sensor-radius 6 --rrd one_trial.rrd\n\n\
        Exit codes: 0 done, 1 the run failed, 2 wrong arguments or input, 130 interrupted (Ctrl-C; what is \
        finished is reported)."
)]
pub(crate) struct Args {
    /// A world: a shipped one by its name (see --list-worlds), or a TOML file. Can be repeated
    /// [default: two_blocks, unless --generate is given]
    #[arg(long, value_name = "NAME|FILE", help_heading = "Where")]
    pub(crate) world: Vec<String>,

    /// Make so many random worlds, from --seed on
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000), help_heading = "Where")]
    pub(crate) generate: Option<u64>,

    /// List the shipped worlds and end
    #[arg(long, help_heading = "Where")]
    pub(crate) list_worlds: bool,

    /// How far the robot sees, in cells, instead of what the world says
    #[arg(long, value_name = "CELLS", value_parser = clap::value_parser!(u32).range(1..=100), help_heading = "Where")]
    pub(crate) sensor_radius: Option<u32>,

    /// Moves of blocks and of the robot happen only with this probability, instead of what the world
    /// says; 0.8 without a number
    #[arg(long, value_name = "CHANCE", num_args = 0..=1, default_missing_value = "0.8", value_parser = chance, help_heading = "Where")]
    pub(crate) stochastic: Option<f64>,

    /// Where the robot goes. Can be repeated
    #[arg(long, default_values = ["curious", "recency", "poisson", "random", "coin"], value_parser = strategies(), help_heading = "What to compare")]
    pub(crate) strategy: Vec<TrialStrategy>,

    /// How rates of change are estimated. Can be repeated [default: the paper's, and this program's
    /// choice]
    #[arg(long, value_parser = estimators(), help_heading = "What to compare")]
    pub(crate) estimator: Vec<Estimator>,

    /// Trials of each combination, with seeds that count up from --seed
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u64).range(1..=100_000), help_heading = "What to compare")]
    pub(crate) trials: u64,

    /// Steps of each trial
    #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000), help_heading = "What to compare")]
    pub(crate) steps: u64,

    /// The seed of all chance: equal seeds give equal results, on any number of threads
    #[arg(long, default_value_t = 0, help_heading = "What to compare")]
    pub(crate) seed: u64,

    /// The bound on the steps of local exploration at a goal; 42 in the paper
    #[arg(long, value_name = "STEPS", default_value_t = 42, help_heading = "What to compare")]
    pub(crate) max_steps: u32,

    /// What the learner is rewarded for
    #[arg(long, value_enum, default_value_t = RewardChoice::Changes, help_heading = "What to compare")]
    pub(crate) reward: RewardChoice,

    /// Threads to run on [default: as many as there are cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = "How to run")]
    pub(crate) threads: Option<u16>,

    /// The folder for everything that comes out
    #[arg(long, value_name = "DIR", default_value = "grid_world_out", help_heading = "What comes out")]
    pub(crate) out: PathBuf,

    /// Record one trial, the first of all, for watching with `rerun FILE`; at most 20,000 of its steps
    #[arg(long, value_name = "FILE", help_heading = "What comes out")]
    pub(crate) rrd: Option<PathBuf>,

    /// Save the worlds that --generate makes as TOML files in the output folder
    #[arg(long, requires = "generate", help_heading = "What comes out")]
    pub(crate) save_worlds: bool,

    /// Print nothing but errors
    #[arg(long, short, help_heading = "What comes out")]
    pub(crate) quiet: bool,
}

/// What counts as a map update when the learner is rewarded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RewardChoice {
    /// Cells that change
    Changes,
    /// Cells seen for the first time, too
    ChangesAndDiscoveries,
}

impl From<RewardChoice> for Reward {
    fn from(choice: RewardChoice) -> Self {
        match choice {
            RewardChoice::Changes => Self::Changes,
            RewardChoice::ChangesAndDiscoveries => Self::ChangesAndDiscoveries,
        }
    }
}

/// A parser of one of `all`, by its name.
fn one_of<T: Copy + Send + Sync + 'static>(
    all: Vec<T>,
    name: impl Fn(T) -> &'static str + Copy + Send + Sync + 'static,
) -> impl TypedValueParser<Value = T> {
    let names: Vec<_> = all.iter().map(|&value| name(value)).collect();
    PossibleValuesParser::new(names).try_map(move |text| {
        all.iter().copied().find(|&value| name(value) == text).ok_or("not one of the possible values")
    })
}

fn strategies() -> impl TypedValueParser<Value = TrialStrategy> {
    let named = |strategy: &TrialStrategy| PossibleValue::new(strategy.name()).help(strategy.description());
    let all: Vec<_> = TrialStrategy::all().collect();
    PossibleValuesParser::new(all.iter().map(named)).try_map(move |name| {
        all.iter().find(|strategy| strategy.name() == name).cloned().ok_or("not one of the possible values")
    })
}

fn estimators() -> impl TypedValueParser<Value = Estimator> {
    one_of(Estimator::ALL.to_vec(), Estimator::name)
}

fn chance(text: &str) -> Result<f64, String> {
    let chance = text.parse::<f64>().unwrap_or(f64::NAN);
    if chance > 0.0 && chance <= 1.0 { Ok(chance) } else { Err("must be above 0, and at most 1".into()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Args::command().debug_assert();
    }

    #[test]
    fn chances_are_probabilities() {
        assert_eq!(chance("0.5"), Ok(0.5));
        for wrong in ["", "0", "-1", "1.1", "nan", "inf", "often"] {
            assert!(chance(wrong).is_err(), "{wrong}");
        }
    }
}

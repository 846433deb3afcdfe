//! The command line.

use clap::Parser;
use curious::flags::folder;
use curious::program::one_of;
use curious::shards::ShardCommand;
use curious::trials::{TrialArgs, strategies};
use evaluation::trials::TrialStrategy;
use mapper::EstimatorChoice;
use std::path::PathBuf;

/// Compares exploration strategies in grid worlds with moving blocks: the paper's Figure 3, with statistics.
///
/// Without options, the paper's learner (curious) is compared in the paper's world with each of its strategies
/// alone (recency, poisson) and with two baselines (random, coin), in five trials of 20,000 steps each. The
/// folder grid_world_out contains the results: the curves (figure3.svg, figure3.png), every number
/// (report.json), and every trial (trials.csv, trials.parquet). The table at the end shows which strategy learned the rates of
/// change best, and whether the difference is significant.
///
/// Options that can be repeated multiply: 2 worlds, 2 estimators, 3 strategies and 10 trials are 120 trials in
/// total.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "grid_world",
    version,
    max_term_width = 100,
    args_conflicts_with_subcommands = true,
    after_help = "Examples:\n  \
        grid_world --trials 100                                  more trials, smaller intervals\n  \
        grid_world --generate 50 --trials 2 --strategy curious --strategy progress\n  \
        grid_world --world my_world.toml --sensor-radius 6 --rrd one_trial.rrd\n\n\
        Large experiments run in shards, on one machine or on many (docs/clusters.md):\n  \
        grid_world --trials 1000 --shard 1/3 --out big     # and 2/3 and 3/3, anywhere, at any time\n  \
        grid_world status big\n  \
        grid_world merge big                               # the same files as without shards\n\n\
        Exit codes: 0 success, 1 the run failed, 2 invalid arguments or input, 130 interrupted (Ctrl-C; the \
        finished trials are reported)."
)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Option<ShardCommand>,

    /// A world: the name of a shipped world (see --list-worlds), or a TOML file. Can be repeated
    /// [default: two_blocks, unless --generate is given]
    #[arg(long, value_name = "NAME|FILE", help_heading = "World")]
    pub(crate) world: Vec<String>,

    /// List the shipped worlds and exit
    #[arg(long, help_heading = "World")]
    pub(crate) list_worlds: bool,

    /// The range of the sensor, in cells, instead of the range in the world file
    #[arg(long, value_name = "CELLS", value_parser = clap::value_parser!(u32).range(1..=100), allow_negative_numbers = true, help_heading = "World")]
    pub(crate) sensor_radius: Option<u32>,

    /// The probability of every move of a block and of the robot, instead of the probabilities in the world
    /// file; 0.8 without a number
    #[arg(long, value_name = "PROBABILITY", num_args = 0..=1, default_missing_value = "0.8", value_parser = probability, help_heading = "World")]
    pub(crate) stochastic: Option<f64>,

    /// The strategy of the robot. Can be repeated
    #[arg(long, default_values = ["curious", "recency", "poisson", "random", "coin"], value_parser = strategies(), help_heading = "Comparison")]
    pub(crate) strategy: Vec<TrialStrategy>,

    /// The estimator of the rates of change. Can be repeated [default: the paper's, and this program's choice]
    #[arg(long, value_parser = one_of(EstimatorChoice::all(), EstimatorChoice::name), help_heading = "Comparison")]
    pub(crate) estimator: Vec<EstimatorChoice>,

    /// Trials of each combination, with seeds that count up from --seed
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u64).range(1..=100_000), allow_negative_numbers = true, help_heading = "Comparison")]
    pub(crate) trials: u64,

    /// Steps of each trial
    #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000), allow_negative_numbers = true, help_heading = "Comparison")]
    pub(crate) steps: u64,

    /// The maximum number of steps of local exploration at a goal; 42 in the paper
    #[arg(
        long,
        value_name = "STEPS",
        default_value_t = 42,
        allow_negative_numbers = true,
        help_heading = "Comparison"
    )]
    pub(crate) max_steps: u32,

    /// The folder for all results
    #[arg(long, value_name = "DIR", default_value = "grid_world_out", value_parser = folder(), help_heading = "Output")]
    pub(crate) out: PathBuf,

    #[command(flatten)]
    pub(crate) shared: TrialArgs,
}

fn probability(text: &str) -> Result<f64, String> {
    let probability = text.parse::<f64>().unwrap_or(f64::NAN);
    if probability > 0.0 && probability <= 1.0 {
        Ok(probability)
    } else {
        Err("must be above 0, and at most 1".into())
    }
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
    fn probabilities_are_checked() {
        assert_eq!(probability("0.5"), Ok(0.5));
        for wrong in ["", "0", "-1", "1.1", "nan", "inf", "often"] {
            assert!(probability(wrong).is_err(), "{wrong}");
        }
    }
}

//! The command line.

use clap::Parser;
use curious::flags::folder;
use curious::program::{duration_s, one_of, pose_in_world, pose_mode};
use curious::shards::ShardCommand;
use curious::trials::{TrialArgs, strategies};
use evaluation::trials::TrialStrategy;
use interfaces::PoseMode;
use mapper::EstimatorChoice;
use std::path::PathBuf;

/// Compares exploration strategies in houses with doors, people and furniture: physics worlds, with statistics.
///
/// Without options, five strategies are compared in eight generated houses, for 20 simulated minutes each: about four
/// minutes on two cores. The folder house_trials_out contains the results: the curves (curves.svg, curves.png, and with
/// several worlds curves-all-worlds.svg and .png), every number (report.json), and every trial (trials.csv, trials.parquet). The table
/// at the end shows which strategy learned the rates of change best, and whether the difference is significant.
///
/// Two references show how far a strategy can get: oracle knows the true rates, and full-observation sees every cell
/// all the time.
///
/// Options that can be repeated multiply: 2 worlds, 2 estimators, 3 strategies and 10 trials are 120 trials in
/// total.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "house_trials",
    version,
    max_term_width = 100,
    args_conflicts_with_subcommands = true,
    after_help = "Examples:\n  \
        house_trials --generate 20 --strategy curious --strategy information-gain\n  \
        house_trials --world house --world office --trials 3 --duration 1h\n  \
        house_trials --generate 2 --seed 7 --duration 60s --save-worlds\n\n\
        Large experiments run in shards, on one machine or on many (docs/clusters.md):\n  \
        house_trials --trials 1000 --shard 1/3 --out big     # and 2/3 and 3/3, anywhere, at any time\n  \
        house_trials status big\n  \
        house_trials merge big                               # the same files as without shards\n\n\
        Exit codes: 0 success, 1 the run failed, 2 invalid arguments or input, 130 interrupted (Ctrl-C; the \
        finished trials are reported)."
)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Option<ShardCommand>,

    /// A world: the name of a shipped world (see --list-worlds), a TOML file, or a Stage file (.world). Can be
    /// repeated [default: eight generated houses, unless --generate is given]
    #[arg(long, value_name = "NAME|FILE", help_heading = "World")]
    pub(crate) world: Vec<String>,

    /// List the shipped worlds and exit
    #[arg(long, help_heading = "World")]
    pub(crate) list_worlds: bool,

    /// The strategy of the robot. Can be repeated
    #[arg(long, default_values = ["curious", "recency", "poisson", "random", "information-gain"], value_parser = strategies(), help_heading = "Comparison")]
    pub(crate) strategy: Vec<TrialStrategy>,

    /// The estimator of the rates of change. Can be repeated
    #[arg(long, default_value = "two-state-gaps", value_parser = one_of(EstimatorChoice::all(), EstimatorChoice::name), help_heading = "Comparison")]
    pub(crate) estimator: Vec<EstimatorChoice>,

    /// Trials of each combination, with seeds that count up from --seed
    #[arg(long, visible_alias = "seeds", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=100_000), allow_negative_numbers = true, help_heading = "Comparison")]
    pub(crate) trials: u64,

    /// The simulated time of each trial: whole seconds, or with a unit as in 90s, 20m, 1h
    #[arg(long, value_name = "TIME", default_value = "20m", value_parser = whole_s, allow_negative_numbers = true, help_heading = "Comparison")]
    pub(crate) duration: u64,

    /// The maximum number of steps of local exploration at a goal
    #[arg(
        long,
        value_name = "STEPS",
        default_value_t = 15,
        allow_negative_numbers = true,
        help_heading = "Comparison"
    )]
    pub(crate) max_steps: u32,

    /// How the robot knows its pose [default: exact where the world's odometry is exact, otherwise localized]
    #[arg(long, value_parser = pose_mode(pose_in_world), help_heading = "Comparison")]
    pub(crate) pose: Option<PoseMode>,

    /// The folder for all results
    #[arg(long, value_name = "DIR", default_value = "house_trials_out", value_parser = folder(), help_heading = "Output")]
    pub(crate) out: PathBuf,

    #[command(flatten)]
    pub(crate) shared: TrialArgs,
}

/// A time in whole seconds.
fn whole_s(text: &str) -> Result<u64, String> {
    let time_s = duration_s(text)?;
    if time_s >= 1.0 && time_s.fract() == 0.0 {
        Ok(time_s as u64)
    } else {
        Err("must be whole seconds".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use evaluation::trials::PhysicsRobot;

    #[test]
    fn the_command_line_is_sound() {
        Args::command().debug_assert();
        let args = Args::parse_from(["house_trials"]);
        assert_eq!(args.max_steps, PhysicsRobot::default().max_steps);
        assert_eq!(args.estimator, [EstimatorChoice::default()]);
    }

    #[test]
    fn times_are_whole_seconds() {
        assert_eq!([whole_s("20m"), whole_s("1"), whole_s("0.5h")], [Ok(1200), Ok(1), Ok(1800)]);
        assert!(["0.5", "1.25s", "-1", "nan", "x"].iter().all(|wrong| whole_s(wrong).is_err()));
    }
}

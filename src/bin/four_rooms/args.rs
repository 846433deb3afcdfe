//! The command line.

use agent::Policy;
use clap::builder::TypedValueParser;
use clap::{Parser, ValueEnum};
use cli::flags::{folder, input_file, output_file};
use cli::program::{duration_s, one_of, pose_in_world};
use interfaces::PoseMode;
use mapper::{EstimatorChoice, OccupancyChoice};
use std::path::PathBuf;
use viewer::recording::Live;

/// Runs a curious robot in a physics world: it maps a changing building and learns where, and how often, the
/// building changes.
///
/// Without options, the curious agent explores the paper's four rooms for 20 simulated minutes. The folder
/// four_rooms_out contains the results: pictures of the maps (figure5.png) and of the trajectories
/// (trajectory.png), a recording (four_rooms.rrd, named after the world; open it with `rerun FILE`), the map in ROS
/// format (map.yaml, map.pgm), the statistics of every cell (cell_statistics.csv), doors and objects that come and go (things.json), the estimated and the true
/// trajectory (trajectory.tum, trajectory_true.tum, in the TUM format), and all results as JSON
/// (summary.json).
///
/// The results of an earlier run in the folder stay until the new ones are complete; until then the new ones are in its
/// subfolder unfinished_run. Other files are never removed or replaced: where one has the name of a result, the run is
/// rejected before it begins.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "four_rooms",
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 success, 1 the run failed, 2 invalid arguments or input, 130 interrupted (Ctrl-C, SIGTERM or SIGHUP; \
                  the results so far are written)."
)]
pub(crate) struct Args {
    /// The world: the name of a shipped world (see --list-worlds), a TOML file, or a Stage file (.world)
    #[arg(long, value_name = "NAME|FILE", default_value = "four_rooms", help_heading = "World")]
    pub(crate) world: String,

    /// List the shipped worlds and exit
    #[arg(long, help_heading = "World")]
    pub(crate) list_worlds: bool,

    /// Start from a known map: a ROS map.yaml with its image
    #[arg(long, value_name = "MAP.YAML", value_parser = input_file(), help_heading = "World")]
    pub(crate) map: Option<PathBuf>,

    /// The seed of all random streams: equal seeds give equal runs, bit for bit
    #[arg(long, default_value_t = 0, allow_negative_numbers = true, help_heading = "World")]
    pub(crate) seed: u64,

    /// The length of the run in simulated time: seconds, or with a unit as in 90s, 20m, 1h
    #[arg(long, value_name = "TIME", default_value = "20m", value_parser = duration_s, allow_negative_numbers = true, help_heading = "World")]
    pub(crate) duration: f64,

    /// The pilot of the curious robot
    #[arg(long, value_enum, default_value_t = DriveChoice::Agent, help_heading = "Pilot")]
    pub(crate) drive: DriveChoice,

    /// The waypoints for --drive tour, a TOML file [default: the shipped tour of the four rooms]
    #[arg(long, value_name = "FILE", value_parser = input_file(), help_heading = "Pilot")]
    pub(crate) tour: Option<PathBuf>,

    /// How the robot knows its pose [default: exact where the world's odometry is exact, otherwise localized]
    #[arg(long, value_parser = one_of(PoseMode::LIVE.to_vec(), pose_in_world), help_heading = "Robot")]
    pub(crate) pose: Option<PoseMode>,

    /// The strategy of the agent [default: curious]
    #[arg(long, value_parser = strategies(), help_heading = "Pilot")]
    pub(crate) strategy: Option<Policy>,

    /// The speed as a multiple of real time, or max for full speed
    #[arg(long, value_name = "FACTOR|max", default_value = "max", value_parser = speed, allow_negative_numbers = true, help_heading = "Pilot")]
    pub(crate) speed: f64,

    /// The share of the time that the robot can be on patrol, for example 0.05: it has a battery, and a dock where it starts and
    /// rests, and returns before the battery is empty [default: as in the world file, otherwise always]
    #[arg(long, value_name = "SHARE", value_parser = share, allow_negative_numbers = true, help_heading = "Pilot")]
    pub(crate) patrol: Option<f64>,

    /// The estimator of the rates of change: shared-prior predicts best where doors, people and robots move
    /// (docs/estimators.md)
    #[arg(long, default_value = "shared-prior", value_parser = one_of(EstimatorChoice::all(), |it| (it.name(), None)), help_heading = "Mapper")]
    pub(crate) estimator: EstimatorChoice,

    /// The occupancy model: steady (static walls rarely change) or naive (every beam counts, as in the paper)
    #[arg(long, default_value = "steady", value_parser = one_of(OccupancyChoice::all(), |it| (it.name(), None)), help_heading = "Mapper")]
    pub(crate) occupancy: OccupancyChoice,

    /// The folder for all results
    #[arg(long, value_name = "DIR", default_value = "four_rooms_out", value_parser = folder(), help_heading = "Output")]
    pub(crate) out: PathBuf,

    /// The file of the recording [default: named after the world, in the output folder]
    #[arg(long, value_name = "FILE", value_parser = output_file(), conflicts_with = "no_rrd", help_heading = "Output")]
    pub(crate) rrd: Option<PathBuf>,

    /// Do not record: the run is about twice as fast
    #[arg(long, help_heading = "Output")]
    pub(crate) no_rrd: bool,

    /// Save the state of the run in a file, at the end and every minute. If the file exists, the run continues,
    /// with the same results as an uninterrupted run: give the same world, seed and settings. --duration is the total
    /// simulated time; the recording, the animation and the trajectories cover only this command
    #[arg(long, value_name = "FILE", value_parser = output_file(), help_heading = "Output")]
    pub(crate) state: Option<PathBuf>,

    /// The wall time between two savings of the state
    #[arg(long, value_name = "TIME", default_value = "1m", value_parser = duration_s, requires = "state", help_heading = "Output")]
    pub(crate) state_every: f64,

    /// Continue from the state of another build of this program; the results may differ from those of both builds
    #[arg(long, requires = "state", help_heading = "Output")]
    pub(crate) allow_other_build: bool,

    /// Write an animation of the run, a GIF file; the run takes some seconds more
    #[arg(long, value_name = "FILE", value_parser = gif, help_heading = "Output")]
    pub(crate) gif: Option<PathBuf>,

    /// Show the run live: start the Rerun viewer (pip install rerun-sdk==0.36.3)
    #[arg(long, help_heading = "Output")]
    pub(crate) view: bool,

    /// Show the run live in a viewer that already runs, on this machine or another
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "127.0.0.1:9876", value_parser = Live::at, help_heading = "Output")]
    pub(crate) connect: Option<Live>,

    /// Write the run as a bag of ROS 2 too, an MCAP file that Foxglove opens: scans, odometry, tf, maps, changes, goals
    #[arg(long, value_name = "FILE", value_parser = output_file(), help_heading = "Output")]
    pub(crate) mcap: Option<PathBuf>,

    /// Print only errors
    #[arg(long, short, help_heading = "Output")]
    pub(crate) quiet: bool,
}

impl Args {
    /// The strategy of the agent.
    pub(crate) fn strategy(&self) -> Policy {
        self.strategy.clone().unwrap_or_default()
    }
}

impl DriveChoice {
    /// The name on the command line.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Agent => "agent",
            Self::Tour => "tour",
        }
    }
}

/// The pilot of the curious robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DriveChoice {
    /// The agent: it goes where an observation is worth most
    Agent,
    /// A list of waypoints, see --tour
    Tour,
}

fn strategies() -> impl TypedValueParser<Value = Policy> {
    one_of(Policy::built_in().to_vec(), |policy| (policy.name(), Some(policy.description())))
}

fn share(text: &str) -> Result<f64, String> {
    let share = text.parse::<f64>().ok().filter(|share| (1e-4..=1.0).contains(share));
    share.ok_or_else(|| "must be a share of the time from 0.0001 to 1".into())
}

fn gif(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_gif = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gif"));
    if is_gif { Ok(path) } else { Err("must end in .gif".into()) }
}

fn speed(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        _ if text == "max" => Ok(f64::INFINITY),
        Ok(factor) if (0.001..=1e6).contains(&factor) => Ok(factor),
        _ => Err("must be a factor from 0.001 to 1000000, or max".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Args::command().debug_assert();
        assert_eq!(Args::parse_from(["four_rooms"]).strategy().name(), "curious");
    }

    #[test]
    fn speeds_are_factors() {
        assert_eq!(speed("2"), Ok(2.0));
        assert_eq!(speed("max"), Ok(f64::INFINITY));
        for wrong in ["", "0", "-1", "nan", "inf", "fast", "1e-21", "0.0009", "1e7"] {
            assert!(speed(wrong).is_err(), "{wrong}");
        }
    }
}

//! The command line.

use agent::Policy;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Parser, ValueEnum};
use mapper::{Estimator, OccupancyModel};
use std::path::PathBuf;
use viewer::recording::Live;

/// A curious robot maps a house that changes, and learns where it changes and how often.
///
/// Without any option: the paper's four rooms for 20 simulated minutes, driven by the curious
/// agent. What comes out lies in the folder four_rooms_out: pictures of the maps (figure5.png) and
/// of the way (trajectory.png), a recording (four_rooms.rrd, open it with `rerun FILE`), the map
/// in ROS form (map.yaml, map.pgm), the statistics of every cell (cell_statistics.csv) and
/// summary.json.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "four_rooms",
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 done, 1 the run failed, 2 wrong arguments or input, 130 interrupted (Ctrl-C; \
                  what was learned so far is written)."
)]
pub(crate) struct Args {
    /// The world: a shipped one by its name (see --list-worlds), a TOML file, or a world of Stage (.world)
    #[arg(long, value_name = "NAME|FILE", default_value = "four_rooms", help_heading = "What to run")]
    pub(crate) world: String,

    /// List the shipped worlds and end
    #[arg(long, help_heading = "What to run")]
    pub(crate) list_worlds: bool,

    /// Start from a known map: a ROS map.yaml with its image
    #[arg(long, value_name = "MAP.YAML", help_heading = "What to run")]
    pub(crate) map: Option<PathBuf>,

    /// The seed of all chance: equal seeds give equal runs, bit for bit
    #[arg(long, default_value_t = 0, help_heading = "What to run")]
    pub(crate) seed: u64,

    /// How long to run, in simulated time: seconds, or with a unit as in 90s, 20m, 1h
    #[arg(long, value_name = "TIME", default_value = "20m", value_parser = duration_s, help_heading = "What to run")]
    pub(crate) duration: f64,

    /// Who drives the curious robot
    #[arg(long, value_enum, default_value_t = DriveChoice::Agent, help_heading = "Who drives")]
    pub(crate) drive: DriveChoice,

    /// The waypoints of --drive tour, a TOML file; by default the shipped tour of the four rooms
    #[arg(long, value_name = "FILE", help_heading = "Who drives")]
    pub(crate) tour: Option<PathBuf>,

    /// Where the agent goes
    #[arg(long, default_value_t = Policy::default(), value_parser = strategies(), help_heading = "Who drives")]
    pub(crate) strategy: Policy,

    /// Times real time; 1 is real time, max as fast as it goes [default: max, under keyboard 1]
    #[arg(long, value_name = "FACTOR|max", value_parser = speed, help_heading = "Who drives")]
    pub(crate) speed: Option<f64>,

    /// How rates of change are estimated
    #[arg(long, default_value = "two-state-gaps", value_parser = estimators(), help_heading = "How to learn")]
    pub(crate) estimator: Estimator,

    /// How scans become a map: steady (walls never flicker) or naive (every beam counts, as in the
    /// paper)
    #[arg(long, default_value = "steady", value_parser = occupancies(), help_heading = "How to learn")]
    pub(crate) occupancy: OccupancyModel,

    /// The folder for everything that comes out
    #[arg(long, value_name = "DIR", default_value = "four_rooms_out", help_heading = "What comes out")]
    pub(crate) out: PathBuf,

    /// The recording, instead of four_rooms.rrd in the output folder
    #[arg(long, value_name = "FILE", conflicts_with = "no_rrd", help_heading = "What comes out")]
    pub(crate) rrd: Option<PathBuf>,

    /// Make no recording: about twice as fast
    #[arg(long, help_heading = "What comes out")]
    pub(crate) no_rrd: bool,

    /// Make a moving picture of the run, a GIF file
    #[arg(long, value_name = "FILE", help_heading = "What comes out")]
    pub(crate) gif: Option<PathBuf>,

    /// Watch live: start the Rerun viewer (pip install rerun-sdk==0.36.3)
    #[arg(long, help_heading = "What comes out")]
    pub(crate) view: bool,

    /// Watch live in a viewer that runs already, here or elsewhere
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = "127.0.0.1:9876", value_parser = Live::at, help_heading = "What comes out")]
    pub(crate) connect: Option<Live>,

    /// Print nothing but errors
    #[arg(long, short, help_heading = "What comes out")]
    pub(crate) quiet: bool,
}

/// Who drives the curious robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DriveChoice {
    /// The agent: it goes where looking is worth most
    Agent,
    /// You: arrows or WASD drive, space stops, Q ends; best with --view
    Keyboard,
    /// A list of waypoints, see --tour
    Tour,
}

/// A parser of one of `all`, by its name.
fn one_of<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: impl Fn(T) -> &'static str + Copy + Send + Sync + 'static,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(all.iter().map(|&value| name(value))).try_map(move |text| {
        all.iter().copied().find(|&value| name(value) == text).ok_or("not one of the possible values")
    })
}

fn strategies() -> impl TypedValueParser<Value = Policy> {
    let named = |policy: &Policy| PossibleValue::new(policy.name()).help(policy.description());
    PossibleValuesParser::new(Policy::built_in().iter().map(named)).try_map(|name| name.parse::<Policy>())
}

fn estimators() -> impl TypedValueParser<Value = Estimator> {
    one_of(&Estimator::ALL, Estimator::name)
}

fn occupancies() -> impl TypedValueParser<Value = OccupancyModel> {
    one_of(&OccupancyModel::ALL, OccupancyModel::name)
}

/// The longest run, s: 1000 hours.
const MAX_DURATION_S: f64 = 3.6e6;

fn duration_s(text: &str) -> Result<f64, String> {
    let (number, unit_s) = match text.char_indices().next_back() {
        Some((at, 's')) => (&text[..at], 1.0),
        Some((at, 'm')) => (&text[..at], 60.0),
        Some((at, 'h')) => (&text[..at], 3600.0),
        _ => (text, 1.0),
    };
    let time_s = number.trim().parse::<f64>().unwrap_or(f64::NAN) * unit_s;
    if time_s > 0.0 && time_s <= MAX_DURATION_S {
        Ok(time_s)
    } else {
        Err("must be a time above 0 and at most 1000h: seconds, or with a unit as in 90s, 20m, 1h".into())
    }
}

fn speed(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        _ if text == "max" => Ok(f64::INFINITY),
        Ok(factor) if factor > 0.0 && factor.is_finite() => Ok(factor),
        _ => Err("must be a factor above 0, or max".into()),
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
    fn times_have_units() {
        assert_eq!(duration_s("1200"), Ok(1200.0));
        assert_eq!(duration_s("20m"), Ok(1200.0));
        assert_eq!(duration_s("0.5h"), Ok(1800.0));
        for wrong in ["", "m", "-1", "0", "nan", "inf", "1001h", "ten"] {
            assert!(duration_s(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn speeds_are_factors() {
        assert_eq!(speed("2"), Ok(2.0));
        assert_eq!(speed("max"), Ok(f64::INFINITY));
        for wrong in ["", "0", "-1", "nan", "inf", "fast"] {
            assert!(speed(wrong).is_err(), "{wrong}");
        }
    }
}

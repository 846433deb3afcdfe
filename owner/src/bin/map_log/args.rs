//! The command line.

use crate::logs_in_order::Source;
use crate::survey_state_file::Loaded;
use anyhow::{Result, ensure};
use clap::Parser;
use cli::flags::{folder, input_file, number, output_file, time_zone};
use cli::program::{duration_s, one_of};
use interfaces::PoseMode;
use logs::TopicChoice;
use mapper::{EstimatorChoice, NoReturn};
use std::path::PathBuf;
use survey::{LogEntry, SurveySettings, saved_settings};

/// Maps the logs of a robot: where the place changes, how often, and when last.
///
/// A log is a CARMEN log, plain or compressed with gzip, or a bag of ROS 2: a folder, an MCAP file or an SQLite file. If a
/// file is cut off, its undamaged beginning is read. The trajectory is estimated from the scans and the odometry; a stationary laser
/// needs no odometry, and the poses of another SLAM can be used (--pose corrected). Several logs must be of the same place: they
/// are read in the order of their times, and later logs are located in the map of the first. With --state, more logs can be added
/// in later runs, with the same maps and rates as in one run with all logs.
///
/// The folder map_log_out contains the results: a page to read (report.html, one file with its pictures inside, for a phone or
/// for printing) with the places where something changes, pictures of the maps (figure5.png) and of the trajectory (trajectory.png), a recording
/// (map_log.rrd; open it with `rerun FILE`), the map in ROS format (map.yaml) and the map of what is permanent
/// (permanent.yaml), masks for the costmap filters of Nav2 (speed_mask.yaml, keepout_mask.yaml), the statistics of every
/// cell (cell_statistics.csv), the trajectory (trajectory.tum, in the TUM format), and all
/// results as JSON (summary.json).
///
/// The map is evaluated with its own scans: good, usable with care, or not usable, with the reasons and the uncertain places. A map
/// that is not usable is drawn, but has no rates and no masks, is not saved in the state, and the exit code is 3.
///
/// The results of an earlier run in the folder stay until the new ones are complete; until then the new ones are in its
/// subfolder unfinished_run. Other files are never removed or replaced: where one has the name of a result, the run is
/// rejected before it begins.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "map_log",
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 success, 1 the run failed, 2 invalid arguments or input, 3 the map is not usable (the \
                  report says why and where; --accept-map), 130 interrupted (Ctrl-C, SIGTERM or SIGHUP; \
                  in the second pass the results so far are written, with --state the state at any time)."
)]
pub(crate) struct Args {
    /// The logs of one place: CARMEN logs, bags of ROS 2 (folders, MCAP, SQLite)
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,

    /// The topic of a laser in a bag; several are possible [default: all topics of scans]
    #[arg(long, value_name = "TOPIC", help_heading = "Bags")]
    pub(crate) scan_topic: Vec<String>,

    /// The topic of the odometry in a bag [default: the only one]
    #[arg(long, value_name = "TOPIC", help_heading = "Bags")]
    pub(crate) odom_topic: Option<String>,

    /// The frame of the robot in a bag [default: the frame whose pose the odometry gives]
    #[arg(long, value_name = "FRAME", help_heading = "Bags")]
    pub(crate) base_frame: Option<String>,

    /// With --pose corrected, the frame of the map of the other SLAM in a bag [default: map]
    #[arg(long, value_name = "FRAME", help_heading = "Bags")]
    pub(crate) map_frame: Option<String>,

    /// How the poses are known [default: exact for a stationary laser, otherwise localized]
    #[arg(long, value_parser = one_of(PoseMode::ALL.to_vec(), pose_in_log), help_heading = "Poses")]
    pub(crate) pose: Option<PoseMode>,

    /// The side of a cell, m
    #[arg(
        long,
        value_name = "METERS",
        default_value_t = 0.05,
        value_parser = number(0.005..=10.0),
        allow_negative_numbers = true,
        help_heading = "Map"
    )]
    pub(crate) resolution: f64,

    /// The maximum range, m: a beam with a longer range shows free space up to it, and nothing behind
    #[arg(
        long,
        value_name = "METERS",
        default_value_t = 20.0,
        value_parser = number(0.1..=1000.0),
        allow_negative_numbers = true,
        help_heading = "Map"
    )]
    pub(crate) max_range: f64,

    /// The memory that the map may take, GiB: 130 bytes are counted per cell that was seen
    #[arg(
        long,
        value_name = "GIB",
        default_value_t = 2.0,
        value_parser = number(0.001..=1024.0),
        allow_negative_numbers = true,
        help_heading = "Map"
    )]
    pub(crate) map_memory: f64,

    /// The error of ranges and poses together, m: smaller differences are no change [default: learned from the distances between
    /// scans and the surfaces of other passes, 0.02 to 0.1; 0.06 if no place was passed twice; with exact poses 0.03]
    #[arg(long, value_name = "METERS", value_parser = number(0.0..=0.5), allow_negative_numbers = true, help_heading = "Map")]
    pub(crate) noise: Option<f64>,

    /// Hits whose line to the next hit has a smaller angle to the beam are removed: they lie between two surfaces; 0 keeps
    /// all
    #[arg(
        long,
        value_name = "DEGREES",
        default_value_t = 10.0,
        value_parser = number(0.0..=85.0),
        allow_negative_numbers = true,
        help_heading = "Map"
    )]
    pub(crate) shadow_angle: f64,

    /// What beams without a return mean: free space if the scanner has proven trustworthy, always free space, or nothing
    #[arg(long, default_value = "learn", value_parser = one_of(NoReturn::all(), |it| (it.name(), None)), help_heading = "Map")]
    pub(crate) no_return: NoReturn,

    /// The estimator of the rates of change: shared-prior predicts best where doors, people and robots move
    /// (docs/estimators.md)
    #[arg(long, default_value = "shared-prior", value_parser = one_of(EstimatorChoice::all(), |it| (it.name(), None)), help_heading = "Map")]
    pub(crate) estimator: EstimatorChoice,

    /// The time zone of the place, by its IANA name as Europe/Berlin: people and doors have hours by its clocks, with summer time
    /// [default: that of the state, otherwise UTC]
    #[arg(long, value_name = "ZONE", value_parser = time_zone, help_heading = "Map")]
    pub(crate) time_zone: Option<String>,

    /// The folder for all results
    #[arg(long, value_name = "DIR", default_value = "map_log_out", value_parser = folder(), help_heading = "Output")]
    pub(crate) out: PathBuf,

    /// Do not record
    #[arg(long, help_heading = "Output")]
    pub(crate) no_rrd: bool,

    /// Write the run as a bag of ROS 2 too, an MCAP file that Foxglove opens: scans, odometry, tf, maps, changes
    #[arg(long, value_name = "FILE", value_parser = output_file(), help_heading = "Output")]
    pub(crate) mcap: Option<PathBuf>,

    /// Store the learned data in a file. If it exists, the logs are added to it: they must be of the same place, and later than those
    /// before. It is saved at the end and every minute; after an interruption, the same command continues
    #[arg(long, value_name = "FILE", value_parser = output_file(), help_heading = "Output")]
    pub(crate) state: Option<PathBuf>,

    /// The wall time between two savings of the state
    #[arg(long, value_name = "TIME", default_value = "1m", value_parser = duration_s, requires = "state", help_heading = "Output")]
    pub(crate) state_every: f64,

    /// Names for places and doors, a TOML file: tables `place` with name, x_m, y_m, and radius_m (1 without it). With --state, later
    /// runs know the names; a file replaces all names given before
    #[arg(long, value_name = "FILE", value_parser = input_file(), help_heading = "Output")]
    pub(crate) places: Option<PathBuf>,

    /// Use a map that is not usable as if it were: with rates, masks, an entry in --state, and exit code 0. Check the map
    /// first
    #[arg(long, help_heading = "Map")]
    pub(crate) accept_map: bool,

    /// Print only errors
    #[arg(long, short, help_heading = "Output")]
    pub(crate) quiet: bool,
}

/// What the ways to know the poses of a log mean.
fn pose_in_log(mode: &PoseMode) -> (&'static str, Option<&'static str>) {
    let meaning = match mode {
        PoseMode::Exact => "The poses of the log, which are exact",
        PoseMode::Odometry => "The poses of the odometry, with their drift: the map becomes wrong",
        PoseMode::Localized => "The trajectory is found from the scans",
        PoseMode::Corrected => {
            "The poses of another SLAM: of the FLASER lines of a corrected CARMEN log, or of tf from --map-frame to the robot"
        }
    };
    (mode.name(), Some(meaning))
}

impl Args {
    /// How the poses are known, as this run or the one before says it.
    fn pose(&self, saved: Option<&Loaded>) -> Option<PoseMode> {
        self.pose.or_else(|| Some(saved_settings(&saved?.state)?.pose))
    }

    /// What to use of logs, after those of a state.
    ///
    /// # Errors
    ///
    /// When a map is named whose poses are not used.
    pub(crate) fn topics(&self, saved: Option<&Loaded>) -> Result<TopicChoice> {
        let is_corrected = self.pose(saved) == Some(PoseMode::Corrected);
        ensure!(
            is_corrected || self.map_frame.is_none(),
            "--map-frame names the map of another SLAM, whose poses are used with --pose corrected alone: add that, or leave it out"
        );
        Ok(TopicChoice {
            scan_topics: self.scan_topic.clone(),
            odom_topic: self.odom_topic.clone(),
            base_frame: self.base_frame.clone(),
            is_corrected,
            map_frame: self.map_frame.clone(),
        })
    }

    /// The settings of the survey of these logs, after the logs of a state and in its time zone.
    pub(crate) fn settings(&self, sources: &[Source], saved: Option<&Loaded>) -> Result<SurveySettings> {
        let earlier = saved.map(|saved| &saved.logs[..]).unwrap_or_default();
        let given = sources.iter().map(|source| &source.entry);
        let mut logs: Vec<&LogEntry> = earlier.iter().map(|log| &log.entry).collect();
        logs.extend(given.filter(|given| earlier.iter().all(|log| log.entry.content != given.content)));
        let stands = logs.iter().all(|log| log.stands);
        let default = if stands { PoseMode::Exact } else { PoseMode::Localized };
        let mut settings = SurveySettings::of(self.pose(saved).unwrap_or(default));
        ensure!(
            stands || logs.len() == 1 || settings.pose.is_consistent(),
            "the poses of each log begin at its own origin: several logs of a robot that moves need --pose localized, or \
             corrected"
        );
        settings.resolution_m = self.resolution;
        settings.filter.max_range_m = self.max_range;
        settings.filter.no_return = self.no_return;
        settings.filter.min_shadow_angle_rad = self.shadow_angle.to_radians();
        settings.mapper.max_bytes = (self.map_memory * f64::from(1 << 30)) as usize;
        settings.mapper.estimator = self.estimator.clone();
        let saved_zone = saved.and_then(Loaded::time_zone);
        settings.mapper.time_zone = self.time_zone.clone().or(saved_zone).or(settings.mapper.time_zone);
        if let Some(noise_m) = self.noise {
            settings.set_noise(noise_m);
        }
        Ok(settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Args::command().debug_assert();
        let args = Args::parse_from(["map_log", "a.log"]);
        assert_eq!(args.settings(&[], None).unwrap().pose, PoseMode::Exact);
        let args = Args::parse_from(["map_log", "a.log", "--pose", "localized"]);
        assert_eq!(args.settings(&[], None).unwrap(), SurveySettings::default());
    }
}

//! What a log contains.

use interfaces::printable;

/// What a log contains.
#[derive(Clone, Debug, PartialEq)]
pub struct LogSummary {
    /// The number of readings.
    pub scans: usize,
    /// The time from the first to the last reading, after repair, s.
    pub duration_s: f64,
    /// Whether the times are those of the log; `false`: they are unusable and were replaced by a count.
    pub has_times: bool,
    /// The time of the first reading in seconds since the epoch (1970-01-01 UTC); `None` if the log does not say it.
    pub begin_s: Option<f64>,
    /// The number of poses of the odometry, without those that only define a new origin.
    pub odometry_poses: usize,
    /// Whether the laser stands: there is no odometry, or its poses stay within 2 cm and 0.02 rad, and most ranges of the
    /// scans stay as they are. All readings of a log that stands have the same pose.
    pub stands: bool,
    /// The topics of the scans in use; none in a CARMEN log.
    pub scan_topics: Vec<String>,
    /// What was repaired or left out, each a sentence.
    pub notes: Vec<String>,
    /// Why the log cannot be true, or is too little for a map: ranges in millimeters, scans that see nothing, a single scan.
    /// `None` for a log that can be mapped.
    pub impossible: Option<String>,
}

/// Times before this are no times of this epoch but those of a simulation, or of a clock that was never set, s
/// (1973-03-03).
const MIN_EPOCH_S: f64 = 1e8;

/// A time that a log contains, if it can be a time since the epoch, s.
pub(crate) fn since_epoch(time_s: f64) -> Option<f64> {
    (MIN_EPOCH_S..1e11).contains(&time_s).then_some(time_s)
}

/// What to use of a log. By default, everything in a bag is found by the types of the topics and by the frames, and the poses are
/// those of the odometry.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct TopicChoice {
    /// The topics of the scans; all if empty.
    pub scan_topics: Vec<String>,
    /// The topic of the odometry; needed where a bag has several.
    pub odom_topic: Option<String>,
    /// The frame of the robot; by default the frame whose pose the odometry gives.
    pub base_frame: Option<String>,
    /// Whether the poses are those of another SLAM instead of the odometry: in a bag those of tf from `map_frame` to the robot, in a
    /// CARMEN log those of the FLASER lines.
    pub is_corrected: bool,
    /// The frame of the map of this SLAM; by default `map`.
    pub map_frame: Option<String>,
}

/// A name of a frame or a topic without its leading slash: ROS 1 wrote it, ROS 2 does not.
pub(crate) fn bare(name: &str) -> &str {
    name.trim_start_matches('/')
}

/// Names for a sentence, at most ten.
pub(crate) fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    const MAX: usize = 10;
    let mut names: Vec<String> = names.map(str::to_owned).collect();
    names.sort();
    names.dedup();
    let more = names.len().saturating_sub(MAX);
    names.truncate(MAX);
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    names.join(", ") + &rest
}

/// The error for a log that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be opened, read or decompressed.
    #[error("{}: {why}", printable(file))]
    Io {
        /// The name of the file.
        file: String,
        /// The error of the system.
        why: std::io::Error,
    },
    /// The log is damaged, or cannot be used as it is.
    #[error("{}: {}", printable(file), printable(why))]
    Unusable {
        /// The name of the file.
        file: String,
        /// The reason, with the line, the byte or the message that is invalid.
        why: String,
    },
}

impl LogError {
    /// The error for a line that is invalid, with its number from 1.
    pub(crate) fn line(file: &str, line: u64, what: String) -> Self {
        Self::Unusable { file: format!("{file}:{line}"), why: what }
    }
}

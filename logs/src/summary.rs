//! What a log contains.

use nalgebra::Isometry2;

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
    /// Where the poses of the readings come from.
    pub pose_source: PoseSource,
    /// The number of poses of the odometry, without those that only define a new origin.
    pub odometry_poses: usize,
    /// Whether the laser stands: there is no odometry, or its poses stay within 2 cm and 0.02 rad, and most ranges of the
    /// scans stay as they are. All readings of a log that stands have the same pose.
    pub stands: bool,
    /// The first pose of the odometry in its own frame, m and rad: `odom_origin * pose` is the pose of a reading as the log
    /// has it, up to the point where the log sets a new origin.
    pub odom_origin: Isometry2<f64>,
    /// The topics of the scans in use; none in a CARMEN log.
    pub scan_topics: Vec<String>,
    /// What was repaired or left out, each a sentence.
    pub notes: Vec<String>,
    /// Why the log cannot be true, or is too little for a map: ranges in millimeters, scans that see nothing, a single scan.
    /// `None` for a log that can be mapped.
    pub impossible: Option<String>,
}

/// Where the poses of the readings come from.
#[derive(Clone, Debug, PartialEq)]
pub enum PoseSource {
    /// The ODOM lines of a CARMEN log.
    OdometryLines,
    /// The messages of this topic.
    OdometryTopic(String),
    /// The transforms between two frames.
    Transforms {
        /// The frame in which the poses are given.
        odom_frame: String,
        /// The frame of the robot.
        base_frame: String,
    },
    /// The FLASER lines of a corrected CARMEN log.
    ScanLines,
    /// The transforms of another SLAM from its map to the robot.
    Corrected {
        /// The frame of the map.
        map_frame: String,
        /// The frame of the robot.
        base_frame: String,
    },
    /// No odometry and no transform moves: all poses are the same.
    Standing,
}

/// Times before this are no times of this epoch but those of a simulation, or of a clock that was never set, s
/// (1973-03-03).
const MIN_EPOCH_S: f64 = 1e8;

/// A time that a log contains, if it can be a time since the epoch, s.
pub(crate) fn since_epoch(time_s: f64) -> Option<f64> {
    (MIN_EPOCH_S..1e11).contains(&time_s).then_some(time_s)
}

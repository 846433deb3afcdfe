//! What a log contains.

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

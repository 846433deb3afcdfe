//! CARMEN logs (Montemerlo, Roy & Thrun 2003): text, one message per line.
//!
//! ```text
//! PARAM robot_frontlaser_offset 0.1 …
//! ODOM x y theta tv rv accel time host logger_time
//! FLASER n r1 … rn x y theta odom_x odom_y odom_theta time host logger_time
//! ROBOTLASER1 type start fov resolution max_range accuracy remission n r1 … rn m … time host logger_time
//! ```
//!
//! - From a FLASER line come the ranges and the time alone: in *corrected* logs its two poses are both the result of an
//!   earlier estimation. Poses come from ODOM lines, interpolated to the time of the scan. Only on request
//!   ([`TopicChoice::is_corrected`]) they are those of the FLASER lines.
//! - A FLASER line does not name the field of view. It is that of the parameters `laser_front_laser_fov` and
//!   `laser_front_laser_resolution`, if they agree with each other; otherwise, it follows from the number of readings: 180°, in steps
//!   of 1° (180 or 181 readings) or 0.5° (360 or 361 readings), or 100° in steps of 0.25° (400 or 401). Readings go from right to left.
//! - The pose of the laser on the robot is that of the parameters `robot_frontlaser_offset`, `robot_frontlaser_side_offset` (to the
//!   left) and `robot_frontlaser_angular_offset` (rad), or for ROBOTLASER1 lines the one between their two poses, if it is the same in
//!   all lines.
//! - Invalid lines are left out with a note; if most scans or most poses are invalid, the log is refused.
//! - Corrected logs write a second ODOM line after every scan, with the corrected pose of the scan, and with no time or a
//!   meaningless one; the next ODOM line continues from there. Such a line is a new origin of the odometry, not a motion.

mod corrected;
mod geometry;
mod inspection;
mod line;
mod readings;
#[cfg(test)]
mod tests;

use crate::bytes::{Bytes, content_hash};
use crate::choice::TopicChoice;
use crate::error::LogError;
use crate::lines::{self, Lines};
use crate::log::{Log, RawReadings, Source};
use geometry::Geometry;
use line::Line;
use nalgebra::Isometry2;
use readings::Readings;

/// A CARMEN log.
#[derive(Debug)]
pub(crate) struct CarmenLog {
    bytes: Bytes,
    file: String,
    rules: Rules,
}

/// How the lines of a log become readings, by its inspection.
#[derive(Clone, Copy, Debug)]
struct Rules {
    geometry: Geometry,
    /// Whether the times in the log can be compared with each other.
    has_times: bool,
    /// Whether an ODOM line without a time is a new origin of the odometry.
    has_origins: bool,
    /// Whether an ODOM line right after a scan, with its pose, is one as well, whatever its time.
    is_corrected: bool,
    /// Whether the laser stands.
    stands: bool,
    /// Whether the poses are those of the FLASER lines.
    takes_scan_poses: bool,
}

impl CarmenLog {
    /// Opens a log, and inspects it: every line is read once. `file` is its name in messages.
    ///
    /// # Errors
    ///
    /// When the file cannot be read, when most scans or most poses are invalid, when no line is a scan, or when `choice` demands corrected poses and
    /// the log has none. A last line that is cut off is left out, see [`LogSummary::notes`](crate::LogSummary::notes).
    pub(crate) fn open(file: &str, bytes: Bytes, choice: &TopicChoice) -> Result<Log, LogError> {
        let (rules, times_s, mut summary) = inspection::of(&mut Lines::open(&bytes, file)?)?;
        let mut log = Self { bytes, file: file.to_owned(), rules };
        if choice.is_corrected {
            corrected::check(&log, &summary)?;
            log.rules.takes_scan_poses = true;
            corrected::note(&mut summary);
        }
        Ok(Log::new(log, times_s, summary))
    }
}

impl Source for CarmenLog {
    /// The poses are those of the odometry, and begin at the origin.
    fn raw_readings(&self) -> Result<Box<dyn RawReadings + Send>, LogError> {
        Ok(Box::new(Readings::new(Lines::open(&self.bytes, &self.file)?, self.rules)))
    }

    fn content_hash(&self) -> Result<u128, LogError> {
        let io = |why| LogError::Io { file: self.file.clone(), why };
        content_hash([lines::open(&self.bytes)]).map_err(io)
    }

    /// The poses of the laser that the FLASER lines contain; `None` for readings of other lines. In a corrected log they are
    /// the result of an earlier estimation.
    fn reference_poses(&self) -> Result<Option<Vec<Option<Isometry2<f64>>>>, LogError> {
        let mut lines = Lines::open(&self.bytes, &self.file)?;
        let mut poses = Vec::new();
        while let Some(line) = line::next(&mut lines, &self.rules.geometry)? {
            if let Line::Scan(scan) = line {
                poses.push(scan.reference());
            }
        }
        Ok(Some(poses))
    }
}

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
//!   earlier estimation. Poses come from ODOM lines, interpolated to the time of the scan.
//! - A FLASER line does not name the field of view: it is 180°, in steps of 1° (180 or 181 readings) or 0.5° (360 or
//!   361 readings), from right to left.
//! - Corrected logs write a second ODOM line after every scan, without a time, with the corrected pose; the next ODOM
//!   line continues from there. Such a line is a new origin of the odometry, not a motion.

mod line;
mod readings;
mod survey;
#[cfg(test)]
mod tests;

pub(crate) use readings::Readings;

use crate::bytes::Bytes;
use crate::content;
use crate::error::LogError;
use crate::lines::{self, Lines};
use crate::summary::LogSummary;
use line::Line;
use nalgebra::Isometry2;
use survey::Survey;

/// A CARMEN log.
#[derive(Clone, Debug)]
pub(crate) struct CarmenLog {
    bytes: Bytes,
    file: String,
    survey: Survey,
}

impl CarmenLog {
    /// Opens a log, and surveys it: every line is read once. `file` is its name in messages.
    ///
    /// # Errors
    ///
    /// When the file cannot be read, when a line is invalid, or when no line is a scan. A last line that is cut off is
    /// left out, see [`LogSummary::notes`].
    pub(crate) fn open(file: &str, bytes: Bytes) -> Result<Self, LogError> {
        let file = file.to_owned();
        let survey = Survey::of(&mut Lines::open(&bytes, &file)?)?;
        Ok(Self { bytes, file, survey })
    }

    /// What the log contains, and what was repaired.
    pub(crate) fn summary(&self) -> &LogSummary {
        &self.survey.summary
    }

    /// As [`Log::content_hash`](crate::Log::content_hash).
    pub(crate) fn content_hash(&self) -> Result<u128, LogError> {
        let io = |why| LogError::Io { file: self.file.clone(), why };
        content::hash([lines::text(&self.bytes)]).map_err(io)
    }

    /// The readings, in the order of the log, from the first on. The poses are those of the odometry, and begin at the
    /// origin.
    ///
    /// # Errors
    ///
    /// When the file can no longer be opened.
    pub(crate) fn readings(&self) -> Result<Readings, LogError> {
        Ok(Readings::new(Lines::open(&self.bytes, &self.file)?, self.survey.clone()))
    }

    /// The poses of the laser that the FLASER lines contain, one per reading; `None` for readings of other lines. In a
    /// corrected log they are the result of an earlier estimation: for comparison only.
    ///
    /// # Errors
    ///
    /// As for [`CarmenLog::open`].
    pub(crate) fn reference_poses(&self) -> Result<Vec<Option<Isometry2<f64>>>, LogError> {
        let mut lines = Lines::open(&self.bytes, &self.file)?;
        let mut poses = Vec::new();
        while let Some(line) = line::next(&mut lines, &self.survey.geometry)? {
            if let Line::Scan(scan) = line {
                poses.push(scan.reference);
            }
        }
        Ok(poses)
    }
}

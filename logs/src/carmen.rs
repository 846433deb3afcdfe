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

mod geometry;
mod inspection;
mod line;
mod readings;
#[cfg(test)]
mod tests;

use crate::bounds::Unpacked;
use crate::bytes::{Bytes, GZIP, content_hash};
use crate::checks::{MIN_MOTION_M, MIN_MOTION_RAD};
use crate::laser_check::LaserCheck;
use crate::log::{Log, RawReadings, Source};
use crate::summary::{LogError, LogSummary, TopicChoice};
use flate2::bufread::MultiGzDecoder;
use geometry::Geometry;
use interfaces::Spread;
use line::Line;
use nalgebra::Isometry2;
use readings::Readings;
use std::io::{self, BufRead, BufReader, Error, ErrorKind, Read, Seek, SeekFrom};

/// Poses of FLASER lines that stay within this of the odometry, m and rad, are those of the odometry at slightly other times: a robot
/// drives 0.1 m in the 0.1 s between the two.
const SAME: Spread = Spread { m: 0.1, rad: 0.05 };

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
        let (rules, looks, summary) = inspection::of(&mut Lines::open(&bytes, file)?, choice.is_corrected)?;
        let mut log = Self { bytes, file: file.to_owned(), rules };
        if choice.is_corrected {
            log.check_corrected(&summary)?;
            log.rules.takes_scan_poses = true;
        }
        // Which poses are those of the odometry is known only now.
        let (mut laser_check, mut readings) = (LaserCheck::default(), log.raw_readings()?);
        while let Some(reading) = readings.next_reading()?.filter(|_| !summary.stands) {
            laser_check.add(&reading);
        }
        Ok(Log::new(log, looks, laser_check, summary))
    }

    /// Checks that the log has corrected poses.
    ///
    /// # Errors
    ///
    /// When its scans have no poses, when all poses are the same though the laser moves, or when they are those of the odometry.
    fn check_corrected(&self, summary: &LogSummary) -> Result<(), LogError> {
        let why = |what: String| {
            let why = format!(
                "no corrected poses: {what}; without --pose corrected, the poses are found from the scans"
            );
            LogError::Unusable { file: self.file.clone(), why }
        };
        let all = self.reference_poses()?.unwrap_or_default();
        let given: Vec<Isometry2<f64>> = all.iter().flatten().copied().collect();
        let (scans, without) = (all.len(), all.len() - given.len());
        if without > 0 {
            return Err(why(format!(
                "{without} of {scans} scans are ROBOTLASER1 lines, or have an invalid pose; those of FLASER lines would be used"
            )));
        }
        let min_motion = Spread { m: MIN_MOTION_M, rad: MIN_MOTION_RAD };
        if !summary.stands && given.iter().all(|pose| min_motion.contains(&given[0].inv_mul(pose))) {
            let at = given[0].translation.vector;
            return Err(why(format!("those of the FLASER lines are all the same ({}, {})", at.x, at.y)));
        }
        if summary.odometry_poses > 0 && !summary.stands && self.is_odometry(&given)? {
            let limit = format!("within {} m and {} rad", SAME.m, SAME.rad);
            return Err(why(format!(
                "those of the FLASER lines are those of the odometry ({limit}), which --pose odometry uses"
            )));
        }
        Ok(())
    }

    /// Whether the poses of the laser move as the odometry does, over the whole log.
    fn is_odometry(&self, given: &[Isometry2<f64>]) -> Result<bool, LogError> {
        let mut readings = self.raw_readings()?;
        let mut first = None;
        for laser in given {
            let Some(reading) = readings.next_reading()? else { break };
            let odometry = reading.pose * reading.mount;
            let (from_odometry, from_laser) = *first.get_or_insert((odometry, *laser));
            let moved = [from_odometry.inv_mul(&odometry), from_laser.inv_mul(laser)];
            if !SAME.contains(&moved[0].inv_mul(&moved[1])) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

impl Source for CarmenLog {
    /// The poses are those of the odometry, and begin at the origin.
    fn raw_readings(&self) -> Result<Box<dyn RawReadings + Send>, LogError> {
        Ok(Box::new(Readings::new(Lines::open(&self.bytes, &self.file)?, self.rules)))
    }

    fn content_hash(&self) -> Result<u128, LogError> {
        let io = |why| LogError::Io { file: self.file.clone(), why };
        content_hash([open_text(&self.bytes)]).map_err(io)
    }

    /// The poses of the laser that the FLASER lines contain; `None` for readings of other lines. In a corrected log they are
    /// the result of an earlier estimation.
    fn reference_poses(&self) -> Result<Option<Vec<Option<Isometry2<f64>>>>, LogError> {
        let mut lines = Lines::open(&self.bytes, &self.file)?;
        let mut poses = Vec::new();
        while let Some(line) = line::next(&mut lines, &self.rules.geometry)? {
            if let Line::Scan(scan) = line {
                poses.push(scan.reference);
            }
        }
        Ok(Some(poses))
    }
}

// A file as lines of text, plain or compressed.

/// The longest line, in bytes: a file that never ends a line must not fill the memory.
const LONGEST: u64 = 1 << 20;

/// The text of a log; its compression is undone.
type Text = BufReader<Unpacked<Box<dyn Read + Send>>>;

/// Opens a log. The compression is recognized by the content.
fn open_text(bytes: &Bytes) -> io::Result<Text> {
    let mut reader = BufReader::new(bytes.open()?);
    let is_packed = reader.fill_buf()?.starts_with(&GZIP);
    let size = reader.seek(SeekFrom::End(0))?;
    reader.rewind()?;
    let text = match is_packed {
        true => Unpacked::new(Box::new(MultiGzDecoder::new(reader)) as Box<_>, size, "gzip -d FILE"),
        false => Unpacked::plain(Box::new(reader.into_inner()) as Box<_>),
    };
    Ok(BufReader::new(text))
}

/// The lines of a log, one after the other.
struct Lines {
    reader: Text,
    file: String,
    /// The number of the last line, from 1.
    number: u64,
    /// Whether the last line ended with a line feed. Otherwise, it can be cut off.
    is_complete: bool,
    line: Vec<u8>,
}

impl Lines {
    /// Opens a log. The compression is recognized by the content.
    fn open(bytes: &Bytes, file: &str) -> Result<Self, LogError> {
        let reader = open_text(bytes).map_err(|why| LogError::Io { file: file.to_owned(), why })?;
        Ok(Self { reader, file: file.to_owned(), number: 0, is_complete: true, line: Vec::new() })
    }

    /// The next line, `None` at the end. Bytes that are no text are replaced.
    fn next_line(&mut self) -> Result<Option<String>, LogError> {
        self.line.clear();
        let mut limited = self.reader.by_ref().take(LONGEST);
        let read = limited.read_until(b'\n', &mut self.line);
        let count = read.map_err(|why| LogError::Io { file: self.file.clone(), why })?;
        if count == 0 {
            return Ok(None);
        }
        self.number += 1;
        self.is_complete = self.line.ends_with(b"\n");
        if !self.is_complete && count as u64 == LONGEST {
            let why = Error::new(ErrorKind::InvalidData, "a line is longer than 1 MiB: not a log");
            return Err(LogError::Io { file: self.file.clone(), why });
        }
        Ok(Some(String::from_utf8_lossy(&self.line).into_owned()))
    }

    /// The bytes of a compressed file that is cut off, and the bytes of text that could be unpacked; `None` if it is whole so far.
    fn cut(&self) -> Option<(u64, u64)> {
        let text = self.reader.get_ref();
        text.is_cut.then_some((text.packed, text.count))
    }
}

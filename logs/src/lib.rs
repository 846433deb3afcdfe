//! Logs as sources of readings: commands to a recorded robot have no effect. It must not know
//! maps, localizers or programs.
//!
//! [`Log`] reads CARMEN logs, plain or compressed with gzip, and bags of ROS 2: MCAP files, SQLite databases, and folders of
//! them. A log is scanned once for its topics and times when it is opened; then it can be read any number of times, reading by reading.
//! [`assemble`] makes readings of scans, poses and transforms, for logs and for live robots.

mod archive;
pub mod assemble;
mod bag;
mod beam_order;
mod bounds;
mod bytes;
mod carmen;
mod checks;
mod laser_check;
mod log;
mod own_parts;
mod summary;

pub use laser_check::LaserCheck;
pub use log::{Log, Readings};
pub use ros::{self, McapWriter};
pub use summary::{LogError, LogSummary, TopicChoice};

use crate::bag::{Bag, BagFile, in_folder};
use crate::bytes::Bytes;
use crate::carmen::CarmenLog;
use std::path::Path;

// Opening a log: which format it has.

impl Log {
    /// Opens a log, and inspects it: it is read once or twice as a whole. `path` is
    ///
    /// - a CARMEN log, plain or compressed with gzip,
    /// - a file of a bag of ROS 2: MCAP, an SQLite database, or one of them compressed with zstd,
    /// - a folder with such files, in the order of its `metadata.yaml`, or of their names where it is missing.
    ///
    /// The format follows from the content, not from the name. See [`TopicChoice`] for `choice`. Of a
    /// compressed file or an MCAP file that is cut off, what is whole is read.
    ///
    /// # Errors
    ///
    /// When a file cannot be read or is damaged, when it has no usable scan, when corrected poses are chosen and it has none, or when several topics are odometry and
    /// `choice` names no topic of odometry. What can be repaired or left out is no error but a note, see
    /// [`LogSummary::notes`](LogSummary::notes).
    pub fn open(path: &Path, choice: &TopicChoice) -> Result<Self, LogError> {
        let name = path.display().to_string();
        if path.is_dir() {
            let (files, note) = in_folder(path)?;
            return Bag::open(&name, files, choice, note.into_iter().collect());
        }
        match BagFile::open(path)? {
            Some(file) => Bag::open(&name, vec![file], choice, Vec::new()),
            None => CarmenLog::open(&name, Bytes::File(path.to_owned()), choice),
        }
    }
}

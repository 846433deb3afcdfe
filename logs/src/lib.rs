//! Logs as sources of readings: commands to a recorded robot have no effect. It must not know
//! maps, localizers or programs.
//!
//! [`Log`] reads CARMEN logs, plain or compressed with gzip, and bags of ROS 2: MCAP files, SQLite databases, and folders of
//! them. A log is scanned once for its topics and times when it is opened; then it can be read any number of times, reading by reading.
//! [`assemble`] makes readings of scans, poses and transforms, for logs and for live robots.

mod archive;
pub mod assemble;
mod bag;
mod bounds;
mod bytes;
mod carmen;
mod checks;
mod choice;
mod error;
mod lines;
mod log;
mod open;
mod summary;

pub use choice::TopicChoice;
pub use error::LogError;
pub use log::{Log, Readings};
pub use ros::{self, McapWriter};
pub use summary::LogSummary;

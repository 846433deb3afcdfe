//! Logs as sources of readings: commands to a recorded robot have no effect. It must not know
//! maps, localizers or programs.
//!
//! [`Log`] reads CARMEN logs, plain or compressed with gzip, and bags of ROS 2: MCAP files, SQLite databases, and folders of
//! them. A log is scanned once for its topics and times when it is opened; then it can be read any number of times, reading by reading.

mod archive;
mod bag;
mod bounds;
mod bytes;
mod carmen;
mod cdr;
mod choice;
mod content;
mod doubts;
mod error;
mod holes;
mod jumps;
mod lines;
mod log;
mod magic;
mod mcap_out;
mod odometry;
mod open;
mod pace;
mod raw_readings;
mod read_ahead;
pub mod ros;
mod speeds;
mod standing;
mod summary;
mod times;
mod whole_part;

pub use choice::TopicChoice;
pub use error::LogError;
pub use log::{Log, Readings};
pub use mcap_out::McapWriter;
pub use odometry::Odometry;
pub use summary::{LogSummary, PoseSource};

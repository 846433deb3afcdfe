//! Logs as sources of readings: a recorded robot is read like a world that ignores commands.
//!
//! [`CarmenLog`] reads CARMEN logs, plain or compressed with gzip. A log is surveyed when it is opened; after this it
//! can be read any number of times, reading by reading.
//!
//! This crate knows the formats of files and the values of `interfaces`. It must not know maps, localizers or programs.

mod carmen;
mod error;
mod lines;

pub use carmen::{CarmenLog, LogSummary, Readings};
pub use error::LogError;

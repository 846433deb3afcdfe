//! Experiments in shards: parts that run independently, on any number of machines, and are merged into the report of
//! a single run.
//!
//! Trial k of an experiment belongs to shard k mod n. A shard has one file of lines of JSON: a [`Header`] that names
//! the experiment, then one line per finished trial, in the order of finishing. Every line ends with a hash of its
//! text, so that a line that was cut off or edited is noticed.
//!
//! ```text
//! trials ──▶ ShardFile::append ──▶ shard-1-of-3.jsonl ┐
//!                                  shard-2-of-3.jsonl ├──▶ Shards::read ──▶ trials in the order of the experiment
//!                                  shard-3-of-3.jsonl ┘
//! ```

mod file;
mod merge;
mod scan;
mod shard;
#[cfg(test)]
mod tests;

pub use file::ShardFile;
pub use merge::Shards;
pub use scan::Scan;
pub use shard::{Header, InvalidShard, Shard, array};

use evaluation::trials::TrialError;
use files::OutputError;
use std::fmt::Display;
use std::io;
use std::path::Path;

/// The error for files of shards that cannot be written, read or merged.
#[derive(Debug, thiserror::Error)]
pub enum ShardError {
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A file or folder cannot be read, is not the file of this shard, or has shards that cannot be merged: the place, the reason, and
    /// what to do.
    #[error("{0}")]
    Content(String),
    /// A finished trial cannot be written.
    #[error("{0}; free space, and start the shard again: the trials before are kept")]
    Append(OutputError),
    /// A trial cannot run.
    #[error(transparent)]
    Trial(#[from] TrialError),
}

impl ShardError {
    fn read(path: &Path, why: io::Error) -> Self {
        Self::Content(format!("cannot read {}: {why}", path.display()))
    }

    fn content(path: &Path, why: impl Display) -> Self {
        Self::Content(format!("{}: {why}", path.display()))
    }
}

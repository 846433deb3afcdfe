//! State files: what a run has learned and where it stopped, so that another run can go on from there.
//!
//! A [`State`] is a list of named sections of bytes, each with the [`Facts`] that it belongs to: the world, the
//! resolution, the settings. The bytes are the snapshots of the parts of a run. To read a section needs the facts of the
//! present run; a section of other facts is refused. [`LearnedFacts`] writes and reads the parts that every robot has:
//! what it has learned about a place.
//!
//! A file is written under a temporary name, brought to the disk, and renamed: at any time, there is a complete file
//! under the name. It holds a checksum, so that a damaged file is refused. [`StateFile`] writes in a thread of its own.

mod facts;
mod file;
mod format;
#[cfg(test)]
mod layout;
mod learned;

pub use facts::Facts;
pub use file::{LoadError, StateFile, earlier_name, read_state};
pub use format::{LAYOUT, State, StateError};
pub use learned::{
    LearnedFacts, LearnedSnapshot, Session, Sessions, saved_frame, saved_mapper, saved_mapper_with,
    saved_sessions, saved_surfaces, with_map, with_sessions, with_surfaces,
};

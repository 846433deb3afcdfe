//! The source of files for readers: the disk, or a table in memory.

use std::collections::BTreeMap;
use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};

/// The maximum length of a world file or a tour, bytes.
pub const MAX_TEXT_BYTES: u64 = 16 << 20;

/// Something that files can be read from.
///
/// Readers use this trait instead of opening files, so that worlds can be part of the program, and tests need no
/// disk.
pub trait Files {
    /// The complete content of the file at `path`.
    ///
    /// # Errors
    ///
    /// When the file does not exist, cannot be read, or has more than `max_bytes` bytes.
    fn read(&self, path: &Path, max_bytes: u64) -> Result<Vec<u8>>;
}

/// The files on the disk of this machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path, max_bytes: u64) -> Result<Vec<u8>> {
        files::read(path, max_bytes)
    }
}

/// Files in memory, by their paths.
impl Files for BTreeMap<PathBuf, Vec<u8>> {
    fn read(&self, path: &Path, max_bytes: u64) -> Result<Vec<u8>> {
        match self.get(path) {
            Some(bytes) => files::within(bytes.clone(), max_bytes),
            None => Err(Error::new(ErrorKind::NotFound, "no such file")),
        }
    }
}

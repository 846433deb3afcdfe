//! The source of files for readers: the disk, or a table in memory.

use std::collections::BTreeMap;
use std::io::{Error, ErrorKind, Read, Result};
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
    /// When the file does not exist, cannot be read, or has more than `most_bytes` bytes.
    fn read(&self, path: &Path, most_bytes: u64) -> Result<Vec<u8>>;
}

/// The files on the disk of this machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path, most_bytes: u64) -> Result<Vec<u8>> {
        // A reader could wait forever for a pipe or a terminal.
        if !std::fs::metadata(path)?.is_file() {
            return Err(Error::other("it is not a regular file"));
        }
        let mut bytes = Vec::new();
        std::fs::File::open(path)?.take(most_bytes.saturating_add(1)).read_to_end(&mut bytes)?;
        within(bytes, most_bytes)
    }
}

/// Files in memory, by their paths.
impl Files for BTreeMap<PathBuf, Vec<u8>> {
    fn read(&self, path: &Path, most_bytes: u64) -> Result<Vec<u8>> {
        match self.get(path) {
            Some(bytes) => within(bytes.clone(), most_bytes),
            None => Err(Error::new(ErrorKind::NotFound, "no such file")),
        }
    }
}

fn within(bytes: Vec<u8>, most_bytes: u64) -> Result<Vec<u8>> {
    if bytes.len() as u64 > most_bytes {
        return Err(Error::new(ErrorKind::FileTooLarge, format!("it has more than {most_bytes} bytes")));
    }
    Ok(bytes)
}

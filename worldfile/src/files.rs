//! Where readers get their files from: the disk, or a table in memory.

use std::collections::BTreeMap;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::{Path, PathBuf};

/// The maximum length of a world file or a tour, bytes.
pub const MAX_TEXT_BYTES: u64 = 16 << 20;

/// Something that files can be read from.
///
/// Readers take this instead of opening files, so that worlds can ship inside of a program and
/// tests need no disk.
pub trait Files {
    /// All of the file at `path`.
    ///
    /// # Errors
    ///
    /// When there is no such file, it cannot be read, or it has more than `most_bytes`.
    fn read(&self, path: &Path, most_bytes: u64) -> Result<Vec<u8>>;
}

/// The files of this machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path, most_bytes: u64) -> Result<Vec<u8>> {
        // A pipe or a terminal would let a reader wait for ever.
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
        return Err(Error::new(ErrorKind::FileTooLarge, format!("it is longer than {most_bytes} bytes")));
    }
    Ok(bytes)
}

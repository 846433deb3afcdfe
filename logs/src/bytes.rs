//! Where the bytes of a log come from.

use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::NamedTempFile;

/// Where the bytes of a log come from.
#[derive(Clone, Debug)]
pub(crate) enum Bytes {
    File(PathBuf),
    #[cfg(test)]
    Memory(Arc<[u8]>),
    /// A file that was unpacked for us; it is removed with its last owner.
    Unpacked(Arc<NamedTempFile>),
}

/// Bytes in any order.
pub(crate) trait Input: Read + Seek + Send {}
impl<T: Read + Seek + Send> Input for T {}

impl Bytes {
    pub(crate) fn open(&self) -> io::Result<Box<dyn Input>> {
        Ok(match self {
            Self::File(path) => Box::new(File::open(path)?),
            Self::Unpacked(file) => Box::new(file.reopen()?),
            #[cfg(test)]
            Self::Memory(bytes) => Box::new(io::Cursor::new(bytes.clone())),
        })
    }

    /// The path of a file.
    pub(crate) fn path(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Unpacked(file) => Some(file.path()),
            #[cfg(test)]
            Self::Memory(_) => None,
        }
    }

    /// The first bytes, at most 16.
    pub(crate) fn start(&self) -> io::Result<Vec<u8>> {
        let mut start = Vec::new();
        self.open()?.take(16).read_to_end(&mut start)?;
        Ok(start)
    }
}

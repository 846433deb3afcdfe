//! Where the bytes of a log come from.

use std::io::{self, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::NamedTempFile;
use xxhash_rust::xxh3::Xxh3;

/// The first bytes of files by which a format is known, whatever the name is.
pub(crate) const MCAP: [u8; 8] = *b"\x89MCAP0\r\n";
pub(crate) const SQLITE: [u8; 16] = *b"SQLite format 3\0";
pub(crate) const GZIP: [u8; 2] = [0x1f, 0x8b];
pub(crate) const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

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
            Self::File(path) => Box::new(files::open(path)?),
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

/// The hash of all bytes of some files, and of where one ends: XXH3 with 128 bits.
pub(crate) fn content_hash<R: Read>(files: impl IntoIterator<Item = io::Result<R>>) -> io::Result<u128> {
    let mut hash = Xxh3::new();
    for file in files {
        let length = io::copy(&mut file?, &mut hash)?;
        hash.update(&length.to_le_bytes());
    }
    Ok(hash.digest128())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_and_every_border_counts() {
        let of = |files: &[&[u8]]| content_hash(files.iter().map(|bytes| Ok(*bytes))).unwrap();
        let hashes = [of(&[b"ab", b"c"]), of(&[b"a", b"bc"]), of(&[b"abc"]), of(&[b"abd"]), of(&[b"ab"])];
        for (index, one) in hashes.iter().enumerate() {
            assert!(hashes[index + 1..].iter().all(|other| other != one), "{hashes:?}");
        }
        assert_eq!(of(&[b"ab", b"c"]), hashes[0]);
    }
}

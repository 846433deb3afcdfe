//! What a log may hold: a few bytes that unpack to gigabytes must fill neither the memory nor the disk.

use std::io::{self, Error, ErrorKind, Read};
use std::path::Path;

/// The longest name of a topic, a type, an encoding or a frame, bytes: ROS allows 256.
pub(crate) const MAX_NAME_BYTES: usize = 1024;
/// The most scans of a log: 19 days of 10 per second.
const MAX_SCANS: usize = 1 << 24;
/// A file may grow by this factor when it is unpacked: recorded scans grow by 3 to 10.
const MAX_GROWTH: u64 = 100;
/// Chunks are read as a stream and not stored, and those that hold equal pictures grow by far more.
const MAX_CHUNK_GROWTH: u64 = 1000;
/// Any file may grow to this number of bytes.
const ALLOWED_UNPACKED_BYTES: u64 = 64 << 20;
/// No file may grow beyond this number of bytes on the disk.
const MAX_UNPACKED_BYTES: u64 = 16 << 30;
/// The bytes of a disk that stay free when a file is unpacked.
const KEPT_FREE_BYTES: u64 = 256 << 20;

/// The most bytes that the chunks of a file of `packed` bytes may unpack to.
pub(crate) fn max_chunk_bytes(packed: u64) -> u64 {
    packed.saturating_mul(MAX_CHUNK_GROWTH).saturating_add(ALLOWED_UNPACKED_BYTES)
}

/// The most bytes that a file of `packed` bytes may unpack to on the disk.
fn max_unpacked_bytes(packed: u64) -> u64 {
    packed.saturating_mul(MAX_GROWTH).saturating_add(ALLOWED_UNPACKED_BYTES).min(MAX_UNPACKED_BYTES)
}

/// A name that is not too long; `what` it names.
pub(crate) fn name<'a>(what: &str, name: &'a str) -> Result<&'a str, String> {
    let bytes = name.len();
    if bytes > MAX_NAME_BYTES {
        return Err(format!("the name of {what} has {bytes} bytes; at most {MAX_NAME_BYTES} are read"));
    }
    Ok(name)
}

/// Counts one more scan.
pub(crate) fn one_more(scans: usize) -> Result<(), String> {
    let is_full = scans >= MAX_SCANS;
    if is_full {
        Err(format!("more than {MAX_SCANS} scans; at most these are read: split the log"))
    } else {
        Ok(())
    }
}

/// Bytes that are unpacked, up to a bound; then an error. They end where the compressed ones are cut off.
pub(crate) struct Unpacked<R> {
    bytes: R,
    /// The number of compressed bytes.
    pub(crate) packed: u64,
    /// The number of bytes so far.
    pub(crate) count: u64,
    /// Whether the compressed bytes have ended too early.
    pub(crate) is_cut: bool,
    remaining: u64,
    exceeded: String,
}

impl<R> Unpacked<R> {
    /// `bytes` from a file of `packed` bytes. `by_hand` is the program that unpacks it for those who know that it is large.
    pub(crate) fn new(bytes: R, packed: u64, by_hand: &str) -> Self {
        let most = max_unpacked_bytes(packed);
        let exceeded = format!(
            "the {packed} bytes of the file unpack to more than {most}, which is the most that is unpacked; if it is a log, \
             unpack it first: {by_hand}"
        );
        Self { bytes, packed, count: 0, is_cut: false, remaining: most, exceeded }
    }

    /// Bytes that are not compressed: without a bound.
    pub(crate) fn plain(bytes: R) -> Self {
        Self { bytes, packed: 0, count: 0, is_cut: false, remaining: u64::MAX, exceeded: String::new() }
    }

    /// The same, written into a folder with this number of free bytes: others need some of them.
    pub(crate) fn into_folder(self, folder: &Path, free_bytes: Option<u64>) -> Self {
        let most = free_bytes.map_or(u64::MAX, |free| free.saturating_sub(KEPT_FREE_BYTES));
        if most >= self.remaining {
            return self;
        }
        let folder = folder.display();
        let exceeded = format!(
            "it unpacks to more than the {most} bytes that can be used in {folder}, where it is unpacked; free space there, or \
             name another folder by TMPDIR"
        );
        Self { remaining: most, exceeded, ..self }
    }
}

/// The bytes that are free in a folder, where the system says it.
pub(crate) fn free_bytes(folder: &Path) -> Option<u64> {
    #[cfg(unix)]
    return rustix::fs::statvfs(folder).ok().map(|known| known.f_bavail.saturating_mul(known.f_frsize));
    #[cfg(not(unix))]
    return None;
}

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if self.is_cut {
            return Ok(0);
        }
        let count = match self.bytes.read(to) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                self.is_cut = true;
                return Ok(0);
            }
            read => read?,
        };
        let remaining = self.remaining.checked_sub(count as u64);
        let exceeded = || Error::new(ErrorKind::InvalidData, self.exceeded.clone());
        self.remaining = remaining.ok_or_else(exceeded)?;
        self.count += count as u64;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A day of a camera has 100 GiB and more.
    #[test]
    fn only_what_is_stored_has_a_largest_size() {
        assert_eq!(max_unpacked_bytes(1 << 40), MAX_UNPACKED_BYTES);
        assert!(max_chunk_bytes(1 << 30) > 1000 << 30);
        assert_eq!([max_unpacked_bytes(0), max_chunk_bytes(0)], [ALLOWED_UNPACKED_BYTES; 2]);
    }

    #[test]
    fn some_of_a_disk_stays_free() {
        let folder = std::env::temp_dir();
        let unpack = |free| {
            let unpacked = Unpacked::new(&[0; 2000][..], 100, "zstd -d FILE").into_folder(&folder, free);
            std::io::read_to_string(unpacked).map(|text| text.len()).map_err(|error| error.to_string())
        };
        assert_eq!(unpack(free_bytes(&folder)), Ok(2000));
        assert_eq!(unpack(Some(KEPT_FREE_BYTES + 2000)), Ok(2000));
        let error = unpack(Some(KEPT_FREE_BYTES + 1999)).unwrap_err();
        let expected =
            format!("it unpacks to more than the 1999 bytes that can be used in {}", folder.display());
        assert!(error.starts_with(&expected), "{error}");
    }
}

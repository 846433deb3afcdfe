//! What a log may hold: a few bytes that unpack to gigabytes must fill neither the memory nor the disk.

use std::io::{self, Error, ErrorKind, Read};

/// The longest name of a topic, a type, an encoding or a frame, bytes: ROS allows 256.
pub(crate) const MAX_NAME_BYTES: usize = 1024;
/// The most scans of a log: 19 days of 10 per second.
const MAX_SCANS: usize = 1 << 24;
/// A file may grow by this factor when it is unpacked: recorded scans grow by 3 to 10. Chunks are not stored, and those
/// that hold equal pictures grow by far more.
const MAX_GROWTH: u64 = 100;
pub(crate) const MAX_CHUNK_GROWTH: u64 = 1000;
/// Any file may grow to this number of bytes.
const ALLOWED_UNPACKED_BYTES: u64 = 64 << 20;
/// No file may grow beyond this number of bytes.
const MAX_UNPACKED_BYTES: u64 = 16 << 30;

/// The most bytes that `packed` bytes may unpack to.
pub(crate) fn max_unpacked_bytes(packed: u64, growth: u64) -> u64 {
    packed.saturating_mul(growth).saturating_add(ALLOWED_UNPACKED_BYTES).min(MAX_UNPACKED_BYTES)
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

/// Bytes that are unpacked, up to a bound; then an error.
pub(crate) struct Unpacked<R> {
    bytes: R,
    packed: u64,
    remaining: u64,
    by_hand: &'static str,
}

impl<R> Unpacked<R> {
    /// `bytes` from a file of `packed` bytes. `by_hand` is the program that unpacks it for those who know that it is large.
    pub(crate) fn new(bytes: R, packed: u64, by_hand: &'static str) -> Self {
        Self { bytes, packed, remaining: max_unpacked_bytes(packed, MAX_GROWTH), by_hand }
    }
}

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let count = self.bytes.read(to)?;
        let Some(remaining) = self.remaining.checked_sub(count as u64) else {
            let (most, by_hand) = (max_unpacked_bytes(self.packed, MAX_GROWTH), self.by_hand);
            let what = format!(
                "the {} bytes of the file unpack to more than {most}, which is the most that is unpacked; if it is a log, \
                 unpack it first: {by_hand}",
                self.packed
            );
            return Err(Error::new(ErrorKind::InvalidData, what));
        };
        self.remaining = remaining;
        Ok(count)
    }
}

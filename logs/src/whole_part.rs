//! What is whole of a compressed file that is cut off.

use std::io::{self, ErrorKind, Read};

/// Unpacked bytes that end where the compressed ones are cut off.
pub(crate) struct WholePart<R> {
    unpacked: R,
    bytes: u64,
    is_cut: bool,
}

impl<R> WholePart<R> {
    pub(crate) fn of(unpacked: R) -> Self {
        Self { unpacked, bytes: 0, is_cut: false }
    }

    /// Whether the compressed bytes have ended too early.
    pub(crate) fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// The number of unpacked bytes so far.
    pub(crate) fn count(&self) -> u64 {
        self.bytes
    }
}

impl<R: Read> Read for WholePart<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if self.is_cut {
            return Ok(0);
        }
        match self.unpacked.read(to) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                self.is_cut = true;
                Ok(0)
            }
            read => {
                self.bytes += read.as_ref().map_or(0, |count| *count as u64);
                read
            }
        }
    }
}

//! What a file contains, by its first bytes.

use crate::magic::{GZIP, MCAP, ROS1, SQLITE, TAR, TAR_AT, ZIP, ZSTD};
use flate2::bufread::MultiGzDecoder;
use std::io::Read;

/// The bytes by which a file is known: a CARMEN log begins with comments and parameters.
const HEAD: u64 = 8192;
/// The words with which lines of CARMEN logs begin.
const WORDS: [&[u8]; 4] = [b"FLASER ", b"ROBOTLASER1 ", b"ODOM ", b"PARAM "];

/// What a file contains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Content {
    Ros1,
    /// MCAP or SQLite.
    Ros2,
    Carmen,
    Zip,
    Tar,
    Other,
}

impl Content {
    /// Of a file with these first bytes.
    pub(super) fn of(head: &[u8]) -> Self {
        let is_tar = head.get(TAR_AT..).is_some_and(|rest| rest.starts_with(TAR));
        match head {
            _ if head.starts_with(ROS1) => Self::Ros1,
            _ if head.starts_with(&MCAP) || head.starts_with(&SQLITE) => Self::Ros2,
            _ if ZIP.iter().any(|zip| head.starts_with(zip)) => Self::Zip,
            _ if is_tar => Self::Tar,
            _ if is_carmen(head) => Self::Carmen,
            _ => Self::Other,
        }
    }

    /// Of a file with these first bytes, or of what is compressed in it.
    pub(super) fn unpacked(first: &[u8]) -> Self {
        match first {
            _ if first.starts_with(&GZIP) => Self::of(&head(&mut MultiGzDecoder::new(first))),
            _ if first.starts_with(&ZSTD) => zstd::stream::read::Decoder::with_buffer(first)
                .map_or(Self::Other, |mut unpacked| Self::of(&head(&mut unpacked))),
            _ => Self::of(first),
        }
    }
}

/// The first bytes; fewer where they cannot be read.
pub(super) fn head(from: &mut impl Read) -> Vec<u8> {
    let mut bytes = Vec::new();
    let _ = from.take(HEAD).read_to_end(&mut bytes);
    bytes
}

fn is_carmen(head: &[u8]) -> bool {
    head.split(|byte| *byte == b'\n').any(|line| WORDS.iter().any(|word| line.starts_with(word)))
}

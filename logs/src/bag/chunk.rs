//! A chunk of an MCAP file: records, often compressed. It is unpacked as a stream, so that one that claims gigabytes needs
//! no memory.

use super::message::Usable;
use crate::bounds::MAX_NAME_BYTES;
use crate::bytes::Input;
use flate2::CrcReader;
use std::io::{self, BufReader, Cursor, ErrorKind, Read};
use std::sync::Arc;

/// The most bytes of a chunk in the file, and unpacked. The tools of ROS write chunks of some megabytes.
const MAX_PACKED: u64 = 256 << 20;
const MAX_UNPACKED: u64 = 1 << 30;
/// The bytes of a chunk before the name of its compression.
const BEFORE_NAME: usize = 28;

/// A chunk that is being read.
pub(super) struct Chunk {
    records: Box<dyn Read + Send>,
    /// The bytes that are still to come.
    pub(super) remaining: u64,
    /// Whether the file ends within the chunk.
    pub(super) is_cut: bool,
}

impl Chunk {
    /// Reads a chunk of `len` bytes, of which the file has `available`. Its checksum is compared before anything in it is used. What it
    /// unpacks to is added to `unpacked_bytes`, also if it is damaged.
    pub(super) fn read(
        input: &mut dyn Read,
        len: u64,
        available: u64,
        unpacked_bytes: &mut u64,
    ) -> Usable<Self> {
        if len.min(available) > MAX_PACKED {
            return Err(format!("a chunk of {len} bytes; at most {MAX_PACKED} are read"));
        }
        let mut bytes = Vec::with_capacity(len.min(available) as usize);
        let read = input.take(len).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
        let is_cut = (read as u64) < len;
        let mut fields = Fields::new(&bytes);
        let mut header = || {
            fields.skip(16)?; // the times of the first and the last message
            let unpacked = u64::from_le_bytes(fields.array()?);
            let (crc, name) = (u32::from_le_bytes(fields.array()?), fields.name()?);
            Ok((unpacked, crc, name, u64::from_le_bytes(fields.array()?)))
        };
        let (unpacked, expected_crc, compression, packed) =
            header().map_err(|why: String| format!("the header of a chunk of {len} bytes {why}"))?;
        if unpacked > MAX_UNPACKED {
            return Err(format!("a chunk of {unpacked} bytes, unpacked; at most {MAX_UNPACKED} are read"));
        }
        *unpacked_bytes = unpacked_bytes.saturating_add(unpacked);
        let start = BEFORE_NAME + 4 + compression.len() + 8;
        if !is_cut && packed > (bytes.len() - start) as u64 {
            return Err(format!("the records of a chunk have {packed} bytes, but the chunk has {len}"));
        }
        let bytes: Arc<[u8]> = bytes.into();
        let records = || unpack(&compression, bytes.clone(), start as u64);
        if !is_cut && expected_crc != 0 {
            let mut sum = CrcReader::new(records()?.take(unpacked));
            io::copy(&mut sum, &mut io::sink()).map_err(|error| error.to_string())?;
            if sum.crc().sum() != expected_crc {
                return Err("the checksum of a chunk does not match".to_owned());
            }
        }
        Ok(Self { records: records()?, remaining: unpacked, is_cut })
    }

    /// The operation code and the length of the next record; `None` at the end.
    pub(super) fn next_record(&mut self) -> io::Result<Option<(u8, u64)>> {
        if self.remaining == 0 {
            return Ok(None);
        }
        let (code, length) = self.next_start()?;
        if length > self.remaining {
            return Err(io::Error::new(ErrorKind::InvalidData, "a record is longer than its chunk"));
        }
        Ok(Some((code, length)))
    }
}

/// The records of a chunk, which begin at an offset.
fn unpack(compression: &str, bytes: Arc<[u8]>, start: u64) -> Usable<Box<dyn Read + Send>> {
    let mut cursor = Cursor::new(bytes);
    cursor.set_position(start);
    let failed = |error: io::Error| error.to_string();
    Ok(match compression {
        "" => Box::new(cursor),
        "zstd" => Box::new(BufReader::new(zstd::stream::read::Decoder::with_buffer(cursor).map_err(failed)?)),
        "lz4" => Box::new(BufReader::new(lz4::Decoder::new(cursor).map_err(failed)?)),
        other => return Err(format!("a chunk is compressed with `{other}`; zstd, lz4 and none are read")),
    })
}

impl Read for Chunk {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let most = self.remaining.min(to.len() as u64) as usize;
        let count = self.records.read(&mut to[..most])?;
        self.remaining -= count as u64;
        Ok(count)
    }
}

/// Records one after the other.
pub(super) trait Records: Read {
    /// Skips bytes.
    fn skip(&mut self, length: u64) -> io::Result<()>;

    /// The operation code and the length of the next record.
    fn next_start(&mut self) -> io::Result<(u8, u64)> {
        let mut start = [0; 9];
        self.read_exact(&mut start)?;
        let [code, length @ ..] = start;
        Ok((code, u64::from_le_bytes(length)))
    }
}

impl Records for Chunk {
    fn skip(&mut self, length: u64) -> io::Result<()> {
        let skipped = io::copy(&mut self.take(length), &mut io::sink())?;
        if skipped == length { Ok(()) } else { Err(ErrorKind::UnexpectedEof.into()) }
    }
}

impl Records for BufReader<Box<dyn Input>> {
    fn skip(&mut self, length: u64) -> io::Result<()> {
        self.seek_relative(length as i64)
    }
}

/// The fields of a record that were not read yet: little-endian numbers, and names after their length. Errors are the rest of a sentence about the record.
pub(super) struct Fields<'a> {
    bytes: &'a [u8],
}

impl<'a> Fields<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    pub(super) fn skip(&mut self, count: usize) -> Usable<&'a [u8]> {
        let (skipped, rest) = self.bytes.split_at_checked(count).ok_or("ends too early")?;
        self.bytes = rest;
        Ok(skipped)
    }

    pub(super) fn array<const N: usize>(&mut self) -> Usable<[u8; N]> {
        self.skip(N)?.try_into().map_err(|_| "ends too early".to_owned())
    }

    pub(super) fn name(&mut self) -> Usable<String> {
        let length = u32::from_le_bytes(self.array()?) as usize;
        if length > MAX_NAME_BYTES {
            return Err(format!("has a name of {length} bytes; at most {MAX_NAME_BYTES} are read"));
        }
        let bytes = self.skip(length)?;
        String::from_utf8(bytes.to_vec()).map_err(|_| "has a name that is no text".to_owned())
    }
}

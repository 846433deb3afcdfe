//! The end of an MCAP file in a fixed order: the `mcap` crate repeats schemas and channels in the order of a hash map, which is
//! another one in every run. The end is held back, sorted, and written then.

use flate2::Crc;
use std::io::{Result, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The kinds of records (opcodes of the MCAP specification).
const FOOTER: u8 = 0x02;
const SCHEMA: u8 = 0x03;
const CHANNEL: u8 = 0x04;
const DATA_END: u8 = 0x0f;
/// The bytes of a kind and a length before each record.
const HEAD: usize = 9;
/// The bytes of the checksum at the end of the footer.
const CHECKSUM: usize = 4;

/// A file whose end can be held back.
pub(super) struct HeldBack<W> {
    to: W,
    is_end: Arc<AtomicBool>,
    end: Vec<u8>,
}

impl<W: Write> HeldBack<W> {
    /// The file, and the switch that holds back what follows.
    pub(super) fn new(to: W) -> (Self, Arc<AtomicBool>) {
        let is_end = Arc::new(AtomicBool::new(false));
        (Self { to, is_end: is_end.clone(), end: Vec::new() }, is_end)
    }

    /// Writes the end in its order.
    pub(super) fn finish(mut self) -> Result<W> {
        self.to.write_all(&sorted(&self.end))?;
        Ok(self.to)
    }
}

impl<W: Write> Write for HeldBack<W> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        if self.is_end.load(Ordering::Relaxed) { self.end.write(bytes) } else { self.to.write(bytes) }
    }

    fn flush(&mut self) -> Result<()> {
        self.to.flush()
    }
}

/// The end of a file with schemas and channels in the order of their numbers, and with the checksum of this order.
fn sorted(end: &[u8]) -> Vec<u8> {
    let (mut records, mut rest) = (Vec::new(), end);
    while let Some((record, after)) = record(rest) {
        records.push(record);
        rest = after;
        if record[0] == FOOTER {
            break;
        }
    }
    for group in records.chunk_by_mut(|a, b| a[0] == b[0]) {
        if [SCHEMA, CHANNEL].contains(&group[0][0]) {
            group.sort_by_key(|record| {
                record.get(HEAD..HEAD + 2).map(|id| u16::from_le_bytes([id[0], id[1]]))
            });
        }
    }
    let data_end = records.first().filter(|record| record[0] == DATA_END).map_or(0, |record| record.len());
    let mut sorted = records.concat();
    // The checksum is of all between the end of the data and itself.
    if let Some(at) = sorted.len().checked_sub(CHECKSUM).filter(|at| *at > data_end) {
        let mut checksum = Crc::new();
        checksum.update(&sorted[data_end..at]);
        sorted[at..].copy_from_slice(&checksum.sum().to_le_bytes());
    }
    sorted.extend(rest);
    sorted
}

/// The first record, and what follows it.
fn record(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let length = bytes.get(1..HEAD)?.try_into().ok().map(u64::from_le_bytes)?;
    bytes.split_at_checked(HEAD + usize::try_from(length).ok()?)
}

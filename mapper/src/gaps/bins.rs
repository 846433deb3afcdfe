//! The gaps in the view of one cell, in bounded memory.

use crate::ledger::ReadingIndex;

/// Lengths outside of this range count as its ends, so that a table stays small whatever the times
/// are: 2^-20 and 2^40 units.
const SHORTEST: f64 = 1.0 / (1u64 << 20) as f64;
const LONGEST: f64 = (1u64 << 40) as f64;

/// The gaps of one kind: of about one length, and with the same states before and after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bin {
    /// The length's exponent and leading binary digits, then the state before and after.
    key: u16,
    /// The number of gaps.
    pub(super) count: u32,
    /// Their total length, in the unit of the readings' times.
    pub(super) total: f64,
}

/// Binary digits of a length, after the leading one, that tell bins apart: two bins to an octave, and
/// gaps of two and of three steps each for themselves.
const DIGITS: u32 = 1;

impl Bin {
    fn key(length: f64, before: bool, after: bool) -> u16 {
        // The bits of positive numbers grow with them.
        let magnitude = (length.clamp(SHORTEST, LONGEST).to_bits() >> (52 - DIGITS)) as u16;
        magnitude << 2 | u16::from(before) << 1 | u16::from(after)
    }

    /// Whether the cell was blocked before these gaps.
    pub(super) fn before(self) -> bool {
        self.key & 2 != 0
    }

    /// Whether it was blocked after them.
    pub(super) fn after(self) -> bool {
        self.key & 1 != 0
    }

    /// Their mean length.
    pub(super) fn length(self) -> f64 {
        self.total / f64::from(self.count)
    }
}

/// The last gap of a cell: what came back may turn out to be something else than it looked at first.
#[derive(Clone, Copy, Debug)]
struct Last {
    /// The last reading before the gap, and the first after it.
    start: ReadingIndex,
    end: ReadingIndex,
    length: f64,
    before: bool,
    after: bool,
}

/// All gaps of one cell, by length and by the states before and after.
#[derive(Clone, Debug, Default)]
pub(super) struct Bins {
    /// In the order of their keys.
    bins: Vec<Bin>,
    last: Option<Last>,
    count: u32,
}

impl Bins {
    /// Adds a gap between two readings, `length` long, with whether the cell was blocked before and after.
    pub(super) fn add(&mut self, [start, end]: [ReadingIndex; 2], length: f64, [before, after]: [bool; 2]) {
        self.put(length, before, after);
        self.last = Some(Last { start, end, length, before, after });
        self.count += 1;
    }

    /// The cell has been in another state, `after`, since the reading `since`: if that lies before the end of
    /// the last gap, the gap was not what it looked like.
    pub(super) fn correct_last(&mut self, since: ReadingIndex, after: bool) {
        let Some(last) = self.last.filter(|last| since <= last.end) else { return };
        let before = if since <= last.start { after } else { last.before };
        self.take(last.length, last.before, last.after);
        self.put(last.length, before, after);
        self.last = Some(Last { before, after, ..last });
    }

    /// The number of gaps.
    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// The gaps by kind.
    pub(super) fn iter(&self) -> impl Iterator<Item = Bin> + Clone {
        self.bins.iter().copied()
    }

    fn put(&mut self, length: f64, before: bool, after: bool) {
        let key = Bin::key(length, before, after);
        match self.bins.binary_search_by_key(&key, |bin| bin.key) {
            Ok(at) => {
                self.bins[at].count += 1;
                self.bins[at].total += length;
            }
            Err(at) => self.bins.insert(at, Bin { key, count: 1, total: length }),
        }
    }

    fn take(&mut self, length: f64, before: bool, after: bool) {
        let key = Bin::key(length, before, after);
        if let Ok(at) = self.bins.binary_search_by_key(&key, |bin| bin.key) {
            let bin = &mut self.bins[at];
            bin.count -= 1;
            bin.total -= length;
            if bin.count == 0 {
                self.bins.remove(at);
            }
        }
    }
}

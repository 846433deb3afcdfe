//! The gaps in the view of one cell, in bounded memory.

use crate::change::reading_times::ReadingIndex;

/// Lengths outside of this range count as its ends, so that a histogram stays small for all times: 2^-20 and
/// 2^40 units.
const SHORTEST: f64 = 1.0 / (1u64 << 20) as f64;
const LONGEST: f64 = (1u64 << 40) as f64;

/// The gaps of about one length with the same states before and after.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct GapBin {
    /// The length's exponent and leading binary digits, then the state before and after.
    key: u16,
    /// The number of gaps.
    pub count: u32,
    /// Their total length, in the unit of the readings' times.
    pub total: f64,
}

/// Binary digits of a length, after the leading one, that distinguish bins: two bins per octave, with gaps of two
/// and of three steps in bins of their own.
const DIGITS: u32 = 1;

impl GapBin {
    fn key(length: f64, before: bool, after: bool) -> u16 {
        // The bits of positive numbers grow with them.
        let magnitude = (length.clamp(SHORTEST, LONGEST).to_bits() >> (52 - DIGITS)) as u16;
        magnitude << 2 | u16::from(before) << 1 | u16::from(after)
    }

    /// Whether the cell was blocked before these gaps.
    pub fn before(self) -> bool {
        self.key & 2 != 0
    }

    /// Whether the cell was blocked after these gaps.
    pub fn after(self) -> bool {
        self.key & 1 != 0
    }

    /// Their mean length.
    pub fn length(self) -> f64 {
        self.total / f64::from(self.count)
    }
}

/// The last gap of a cell. Later readings can correct the states before and after the gap.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
struct Last {
    /// The last reading before the gap, and the first after it.
    start: ReadingIndex,
    end: ReadingIndex,
    length: f64,
    before: bool,
    after: bool,
}

/// All gaps of one cell, by length and by the states before and after.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct GapHistogram {
    /// In the order of their keys.
    bins: Vec<GapBin>,
    last: Option<Last>,
    count: u32,
}

impl GapHistogram {
    /// Adds a gap between two readings, `length` long, with whether the cell was blocked before and after.
    pub(super) fn add(&mut self, [start, end]: [ReadingIndex; 2], length: f64, [before, after]: [bool; 2]) {
        self.put(length, before, after);
        self.last = Some(Last { start, end, length, before, after });
        self.count += 1;
    }

    /// The cell has been in another state, `after`, since the reading `since`: if that lies before the end of
    /// the last gap, corrects the states of the gap.
    pub(super) fn correct_last(&mut self, since: ReadingIndex, after: bool) {
        let Some(last) = self.last.filter(|last| since <= last.end) else { return };
        let before = if since <= last.start { after } else { last.before };
        self.take(last.length, last.before, last.after);
        self.put(last.length, before, after);
        self.last = Some(Last { before, after, ..last });
    }

    /// The number of gaps.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// The bins that hold a gap, by ascending length.
    pub fn iter(&self) -> impl Iterator<Item = GapBin> + Clone {
        self.bins.iter().copied()
    }

    fn put(&mut self, length: f64, before: bool, after: bool) {
        let key = GapBin::key(length, before, after);
        match self.bins.binary_search_by_key(&key, |bin| bin.key) {
            Ok(at) => {
                self.bins[at].count += 1;
                self.bins[at].total += length;
            }
            Err(at) => self.bins.insert(at, GapBin { key, count: 1, total: length }),
        }
    }

    fn take(&mut self, length: f64, before: bool, after: bool) {
        let key = GapBin::key(length, before, after);
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

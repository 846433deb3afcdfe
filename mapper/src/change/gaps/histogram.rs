//! The gaps in the view of one cell, in bounded memory.

use crate::change::reading_times::ReadingIndex;
use smallvec::SmallVec;

/// Lengths outside of this range are limited to its ends, so that a histogram stays small: 2^-20 to 2^40 units of
/// time.
const SHORTEST: f64 = 1.0 / (1u64 << 20) as f64;
const LONGEST: f64 = (1u64 << 40) as f64;

/// The gaps of about one length with the same states before and after.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(in crate::change) struct GapBin {
    /// The length's exponent and leading binary digits, then the state before and after.
    key: u16,
    /// The number of gaps.
    pub(crate) count: u32,
    /// The sum of the lengths of these gaps, in the time unit of the readings.
    #[serde(with = "interfaces::serde_time")]
    pub(crate) total: f64,
}

/// The number of binary digits of a length, after the leading digit, that distinguish bins: two bins per octave;
/// gaps of two steps and gaps of three steps have separate bins.
const DIGITS: u32 = 1;

/// The number of bins that are allocated for the second bin of a cell, and whenever these are full: many cells have gaps of one
/// length only.
const MORE_BINS: usize = 3;

impl GapBin {
    /// Whether the cell was blocked before these gaps.
    pub(crate) fn before(self) -> bool {
        self.key & 2 != 0
    }

    /// Whether the cell was blocked after these gaps.
    pub(crate) fn after(self) -> bool {
        self.key & 1 != 0
    }

    /// The mean length of these gaps.
    pub(crate) fn length(self) -> f64 {
        self.total / f64::from(self.count)
    }
}

/// A gap in the view of a cell.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub(in crate::change) struct Gap {
    /// The last reading before the gap, and the first after it.
    pub(in crate::change) start: ReadingIndex,
    pub(in crate::change) end: ReadingIndex,
    #[serde(with = "interfaces::serde_time")]
    pub(in crate::change) length: f64,
    /// Whether the cell was blocked before and after the gap.
    pub(in crate::change) before: bool,
    pub(in crate::change) after: bool,
}

impl Gap {
    /// The key of its bin.
    fn key(&self) -> u16 {
        // The bits of a positive floating-point number grow with the number.
        let magnitude = (self.length.clamp(SHORTEST, LONGEST).to_bits() >> (52 - DIGITS)) as u16;
        magnitude << 2 | u16::from(self.before) << 1 | u16::from(self.after)
    }
}

/// All gaps of one cell, by length and by the states before and after.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(from = "Saved", into = "Saved")]
pub(in crate::change) struct GapHistogram {
    /// In the order of their keys.
    bins: SmallVec<[GapBin; 1]>,
    /// The last gap: later readings can correct its states.
    last: Option<Gap>,
}

/// The layout in a state file: the bins, and the last gap.
type Saved = (Vec<GapBin>, Option<Gap>);

impl From<Saved> for GapHistogram {
    fn from((bins, last): Saved) -> Self {
        Self { bins: SmallVec::from_slice(&bins), last }
    }
}

impl From<GapHistogram> for Saved {
    fn from(gaps: GapHistogram) -> Self {
        (gaps.bins.into_vec(), gaps.last)
    }
}

impl GapHistogram {
    /// The memory that the bins own elsewhere, bytes: with that for the allocation itself.
    pub(in crate::change) fn owned_bytes(&self) -> usize {
        if self.bins.spilled() { self.bins.capacity() * size_of::<GapBin>() + size_of::<usize>() } else { 0 }
    }

    /// Adds a gap.
    pub(in crate::change) fn add(&mut self, gap: Gap) {
        self.put(&gap);
        self.last = Some(gap);
    }

    /// The cell has had another state, `after`, since the reading `since`. If `since` is before the end of the last
    /// gap, corrects the states of the gap. Returns whether it is.
    pub(in crate::change) fn correct_last(&mut self, since: ReadingIndex, after: bool) -> bool {
        let Some(last) = self.last.filter(|last| since <= last.end) else { return false };
        if let Ok(at) = self.find(last.key()) {
            let bin = &mut self.bins[at];
            bin.count -= 1;
            bin.total -= last.length;
            if bin.count == 0 {
                self.bins.remove(at);
            }
        }
        let before = if since <= last.start { after } else { last.before };
        let corrected = Gap { before, after, ..last };
        self.put(&corrected);
        self.last = Some(corrected);
        true
    }

    /// The number of gaps.
    pub(crate) fn count(&self) -> u32 {
        self.bins.iter().map(|bin| bin.count).sum()
    }

    /// The bins that hold a gap, by ascending length.
    pub(crate) fn iter(&self) -> impl Iterator<Item = GapBin> + Clone {
        self.bins.iter().copied()
    }

    /// Adds a gap that no later reading corrects.
    pub(in crate::change) fn put(&mut self, gap: &Gap) {
        let key = gap.key();
        match self.find(key) {
            Ok(at) => {
                self.bins[at].count += 1;
                self.bins[at].total += gap.length;
            }
            Err(at) => {
                if self.bins.len() == self.bins.capacity() {
                    self.bins.reserve_exact(MORE_BINS);
                }
                self.bins.insert(at, GapBin { key, count: 1, total: gap.length });
            }
        }
    }

    fn find(&self, key: u16) -> Result<usize, usize> {
        self.bins.binary_search_by_key(&key, |bin| bin.key)
    }
}

//! The gaps in the view of one cell, in bounded memory.

use crate::change::reading_times::ReadingIndex;
use std::num::NonZeroU32;

/// Lengths outside of this range are limited to its ends, so that a histogram stays small: 2^-20 to 2^40 units of
/// time.
const SHORTEST: f64 = 1.0 / (1u64 << 20) as f64;
const LONGEST: f64 = (1u64 << 40) as f64;

/// The gaps of about one length with the same states before and after.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct GapBin {
    /// The length's exponent and leading binary digits, then the state before and after.
    key: u16,
    /// The number of gaps.
    pub count: u32,
    /// The sum of the lengths of these gaps, in the time unit of the readings.
    #[serde(with = "interfaces::serde_time")]
    pub total: f64,
}

/// The number of binary digits of a length, after the leading digit, that distinguish bins: two bins per octave;
/// gaps of two steps and gaps of three steps have separate bins.
const DIGITS: u32 = 1;

impl GapBin {
    /// Whether the cell was blocked before these gaps.
    pub fn before(self) -> bool {
        self.key & 2 != 0
    }

    /// Whether the cell was blocked after these gaps.
    pub fn after(self) -> bool {
        self.key & 1 != 0
    }

    /// The mean length of these gaps.
    pub fn length(self) -> f64 {
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
pub struct GapHistogram {
    /// In the order of their keys.
    bins: Bins,
    /// The last gap: later readings can correct its states.
    last: Option<Packed>,
}

/// Bins in little memory: many cells have gaps of one length only, and few cells get another bin often.
#[derive(Clone, Debug, PartialEq)]
enum Bins {
    One(GapBin),
    /// None, or two or more.
    Other(Box<[GapBin]>),
}

impl Default for Bins {
    fn default() -> Self {
        Self::Other(Box::default())
    }
}

impl From<Vec<GapBin>> for Bins {
    fn from(bins: Vec<GapBin>) -> Self {
        match bins[..] {
            [bin] => Self::One(bin),
            _ => Self::Other(bins.into_boxed_slice()),
        }
    }
}

impl Bins {
    fn all(&self) -> &[GapBin] {
        match self {
            Self::One(bin) => std::slice::from_ref(bin),
            Self::Other(bins) => bins,
        }
    }

    fn at_mut(&mut self, at: usize) -> &mut GapBin {
        match self {
            Self::One(bin) => bin,
            Self::Other(bins) => &mut bins[at],
        }
    }

    fn insert(&mut self, at: usize, bin: GapBin) {
        let (before, after) = self.all().split_at(at);
        let mut bins = Vec::with_capacity(before.len() + 1 + after.len());
        bins.extend_from_slice(before);
        bins.push(bin);
        bins.extend_from_slice(after);
        *self = bins.into();
    }

    fn remove(&mut self, at: usize) {
        let mut bins = self.all().to_vec();
        bins.remove(at);
        *self = bins.into();
    }
}

/// A gap in little memory: readings have less than 32 bits, so that the states fit beside them. The end is never 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Packed {
    /// Two times the reading, plus 1 if the cell was blocked.
    start: u32,
    end: NonZeroU32,
    length: f64,
}

impl Packed {
    /// `None` for a gap that ends before the first reading: there is none.
    fn new(gap: &Gap) -> Option<Self> {
        let end = NonZeroU32::new(gap.end << 1 | u32::from(gap.after))?;
        Some(Self { start: gap.start << 1 | u32::from(gap.before), end, length: gap.length })
    }

    fn gap(self) -> Gap {
        let (end, length) = (self.end.get(), self.length);
        Gap {
            start: self.start >> 1,
            end: end >> 1,
            length,
            before: self.start & 1 == 1,
            after: end & 1 == 1,
        }
    }
}

/// The layout in a state file: the bins, the last gap, and the number of gaps.
type Saved = (Vec<GapBin>, Option<Gap>, u32);

impl From<Saved> for GapHistogram {
    fn from((bins, last, _): Saved) -> Self {
        Self { bins: bins.into(), last: last.as_ref().and_then(Packed::new) }
    }
}

impl From<GapHistogram> for Saved {
    fn from(gaps: GapHistogram) -> Self {
        let count = gaps.count();
        (gaps.bins.all().to_vec(), gaps.last.map(Packed::gap), count)
    }
}

impl GapHistogram {
    /// The memory that the bins own elsewhere, bytes: with that for the allocation itself.
    pub(in crate::change) fn owned_bytes(&self) -> usize {
        match &self.bins {
            Bins::Other(bins) if !bins.is_empty() => size_of_val(&**bins) + size_of::<usize>(),
            _ => 0,
        }
    }

    /// Adds a gap.
    pub(in crate::change) fn add(&mut self, gap: Gap) {
        self.put(&gap);
        self.last = Packed::new(&gap);
    }

    /// The cell has had another state, `after`, since the reading `since`. If `since` is before the end of the last
    /// gap, corrects the states of the gap.
    pub(in crate::change) fn correct_last(&mut self, since: ReadingIndex, after: bool) {
        let Some(last) = self.last.map(Packed::gap).filter(|last| since <= last.end) else { return };
        if let Ok(at) = self.find(last.key()) {
            let bin = self.bins.at_mut(at);
            bin.count -= 1;
            bin.total -= last.length;
            if bin.count == 0 {
                self.bins.remove(at);
            }
        }
        let before = if since <= last.start { after } else { last.before };
        let corrected = Gap { before, after, ..last };
        self.put(&corrected);
        self.last = Packed::new(&corrected);
    }

    /// The last reading before the last gap, and the first after it.
    pub(in crate::change) fn last(&self) -> Option<[ReadingIndex; 2]> {
        self.last.map(Packed::gap).map(|gap| [gap.start, gap.end])
    }

    /// The number of gaps.
    pub fn count(&self) -> u32 {
        self.bins.all().iter().map(|bin| bin.count).sum()
    }

    /// The bins that hold a gap, by ascending length.
    pub fn iter(&self) -> impl Iterator<Item = GapBin> + Clone {
        self.bins.all().iter().copied()
    }

    fn put(&mut self, gap: &Gap) {
        let key = gap.key();
        match self.find(key) {
            Ok(at) => {
                let bin = self.bins.at_mut(at);
                bin.count += 1;
                bin.total += gap.length;
            }
            Err(at) => self.bins.insert(at, GapBin { key, count: 1, total: gap.length }),
        }
    }

    fn find(&self, key: u16) -> Result<usize, usize> {
        self.bins.all().binary_search_by_key(&key, |bin| bin.key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::change::gaps::CellGaps;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    #[test]
    fn the_gaps_of_a_cell_take_48_bytes() {
        assert_eq!([size_of::<Option<Packed>>(), size_of::<CellGaps>()], [16, 48]);
    }

    proptest! {
        /// The simple way: the gaps of each bin in a tree, the last one apart.
        #[test]
        fn gaps_are_counted_as_in_a_tree(
            gaps in prop::collection::vec((1u32..50, any::<bool>(), any::<bool>(), prop::option::of(any::<bool>())), 1..60),
        ) {
            let (mut histogram, mut tree) = (GapHistogram::default(), BTreeMap::<u16, (u32, f64)>::new());
            let mut now = 2;
            for (steps, before, after, correction) in gaps {
                let mut gap = Gap { start: now, end: now + steps, length: f64::from(steps), before, after };
                now = gap.end;
                histogram.add(gap);
                if let Some(after) = correction {
                    // A correction from the end of the gap on changes the state after it.
                    histogram.correct_last(now, after);
                    gap.after = after;
                }
                let bin = tree.entry(gap.key()).or_default();
                *bin = (bin.0 + 1, bin.1 + gap.length);
                prop_assert_eq!(histogram.last.map(Packed::gap), Some(gap));
                prop_assert_eq!(histogram.last(), Some([now - steps, now]));
            }
            let found: Vec<_> = histogram.iter().map(|bin| (bin.key, (bin.count, bin.total))).collect();
            prop_assert_eq!(&found, &tree.into_iter().collect::<Vec<_>>());
            let again = GapHistogram::from(Saved::from(histogram.clone()));
            prop_assert_eq!(again, histogram);
        }
    }
}

use super::{NEVER, ReadingIndex, Slot};
use interfaces::CellState;
use std::num::NonZeroU32;

/// The change record of one cell. The last observation changes with every reading and is stored separately.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Record {
    /// The first observation.
    pub(super) first: ReadingIndex,
    /// The start of the time up to the last observation in which the cell was in view in its present state without
    /// a gap. This time is not in `watched` yet.
    pub(super) since: ReadingIndex,
    /// The time in view while free, and while blocked, up to `since`.
    #[serde(with = "interfaces::serde_time")]
    pub(super) watched: [f64; 2],
    /// Block and free events in view.
    pub(super) in_view: [u32; 2],
    /// Block and free events that were found at the end of a gap.
    pub(super) after_gap: [u32; 2],
    /// Gaps that began while the cell was free, and while it was blocked.
    pub(super) gaps: [u32; 2],
    /// The index among the cells that ever changed, plus one.
    pub(super) slot: Option<NonZeroU32>,
    pub(super) marks: Marks,
}

/// Two marks of a cell in one byte of a state file: the first alone is the byte of earlier versions.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(super) struct Marks(u8);

impl Marks {
    const WHOLE: u8 = 1;
    const CORRECTED: u8 = 2;
}

/// What every observation of a cell asks: many cells are in one line of the processor's cache, of whole records only one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Flags {
    /// Whether the cell can be a goal: free cells can, and the surfaces and frontiers beside free cells.
    pub(super) is_candidate: bool,
    /// Whether the cell ever changed: whether its record has a slot.
    pub(super) has_changed: bool,
}

/// The index of a state in the arrays of a record.
pub(super) const fn state_index(state: CellState) -> usize {
    match state {
        CellState::Unknown | CellState::Free => 0,
        CellState::Blocked => 1,
    }
}

impl Record {
    /// The record of a cell that first became known in a reading.
    pub(super) fn since(first: ReadingIndex) -> Self {
        Self { first, since: first, ..Self::default() }
    }

    /// The record of a cell whose first observation was wrong.
    pub(super) fn corrected(first: ReadingIndex) -> Self {
        Self { marks: Marks(Marks::CORRECTED), ..Self::since(first) }
    }

    /// Whether a wrong first observation was corrected.
    pub(super) fn was_corrected(&self) -> bool {
        self.marks.0 & Marks::CORRECTED != 0
    }

    /// Whether the present state began with an event in view, and the cell has been in view since.
    pub(super) fn is_whole(&self) -> bool {
        self.marks.0 & Marks::WHOLE != 0
    }

    pub(super) fn set_whole(&mut self, is_whole: bool) {
        self.marks = Marks((self.marks.0 & !Marks::WHOLE) | u8::from(is_whole));
    }

    /// Whether the state of the cell is known.
    #[inline]
    pub(super) fn is_known(&self) -> bool {
        self.first != NEVER
    }

    /// The index among the cells that ever changed.
    #[inline]
    pub(super) fn slot(&self) -> Option<Slot> {
        self.slot.map(|slot| slot.get() - 1)
    }

    pub(super) fn set_slot(&mut self, slot: Slot) {
        self.slot = NonZeroU32::new(slot + 1);
    }

    /// The only state in which the cell was ever in view; `None` if it was in both, or ever changed.
    pub(super) fn only_state(&self) -> Option<usize> {
        let is_unused = |state: usize| self.watched[state].to_bits() == 0 && self.gaps[state] == 0;
        let has_events = self.in_view != [0; 2] || self.after_gap != [0; 2] || self.slot.is_some();
        let other = [1, 0].into_iter().find(|other| is_unused(*other)).filter(|_| !has_events);
        other.map(|other| 1 - other)
    }
}

use super::{NEVER, ReadingIndex, Slot};
use interfaces::CellState;

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
    /// The index among the cells that ever changed.
    pub(super) slot: Option<Slot>,
    /// Whether the present state began with an event in view, and the cell has been in view since.
    pub(super) is_whole: bool,
    /// Whether a wrong first observation was corrected.
    pub(super) was_corrected: bool,
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

    /// Whether the state of the cell is known.
    #[inline]
    pub(super) fn is_known(&self) -> bool {
        self.first != NEVER
    }

    /// The only state in which the cell was ever in view; `None` if it was in both, or ever changed.
    pub(super) fn only_state(&self) -> Option<usize> {
        let has_events = self.in_view != [0; 2] || self.after_gap != [0; 2] || self.slot.is_some();
        let is_unused = |state: &usize| self.watched[*state].to_bits() == 0;
        [1, 0].into_iter().find(is_unused).filter(|_| !has_events).map(|other| 1 - other)
    }
}

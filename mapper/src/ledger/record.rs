use super::survival::Slot;
use super::{NEVER, ReadingIndex};
use interfaces::CellState;
use std::num::NonZeroU32;

/// The change record of one cell, except for the time of its last sighting, which is written at
/// every sighting and lies apart.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Record {
    pub(super) first: ReadingIndex,
    /// From here to the last sighting the cell was watched in its present state without a gap,
    /// and that time is not in `watched` yet.
    pub(super) since: ReadingIndex,
    /// Time watched while free and while blocked, over by `since`.
    pub(super) watched: [f64; 2],
    /// Block and free events that happened in view.
    pub(super) in_view: [u32; 2],
    /// Block and free events that were found when the cell came back into view.
    pub(super) after_gap: [u32; 2],
    /// Gaps that began while the cell was free, and while it was blocked.
    pub(super) gaps: [u32; 2],
    /// Its slot among the cells that ever changed and one more.
    slot: Option<NonZeroU32>,
    /// Whether the present state began with an event in view, and was watched since.
    pub(super) is_whole: bool,
}

/// The place of a state's figures in a record.
pub(super) const fn place(state: CellState) -> usize {
    match state {
        CellState::Unknown | CellState::Free => 0,
        CellState::Blocked => 1,
    }
}

impl Record {
    /// Of a cell first known in a reading.
    pub(super) fn since(first: ReadingIndex) -> Self {
        Self { first, since: first, ..Self::default() }
    }

    /// Whether anything is known of the cell.
    #[inline]
    pub(super) fn is_known(&self) -> bool {
        self.first != NEVER
    }

    #[inline]
    pub(super) fn has_changed(&self) -> bool {
        self.slot.is_some()
    }

    /// Its place among the cells that ever changed.
    #[inline]
    pub(super) fn slot(&self) -> Option<Slot> {
        self.slot.map(|slot| slot.get() - 1)
    }

    pub(super) fn set_slot(&mut self, slot: Slot) {
        self.slot = NonZeroU32::new(slot + 1);
    }
}

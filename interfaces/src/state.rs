use crate::Cell;

/// The state of a cell in the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CellState {
    /// Never observed.
    #[default]
    Unknown,
    /// No solid is in the cell.
    Free,
    /// A solid is in the cell.
    Blocked,
}

/// A change of a known cell (paper, section 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Event {
    /// Free to blocked.
    Block,
    /// Blocked to free.
    Free,
}

/// A change of the state of a cell in an update: a first sighting, a change of a known cell, or the correction of a
/// first sighting (the cell becomes unknown again, before it takes its true state).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transition {
    /// The cell.
    pub cell: Cell,
    /// The state before.
    pub before: CellState,
    /// The state after.
    pub after: CellState,
}

impl Transition {
    /// The change of a known cell; `None` for a first sighting or its correction.
    pub fn event(&self) -> Option<Event> {
        match (self.before, self.after) {
            (CellState::Free, CellState::Blocked) => Some(Event::Block),
            (CellState::Blocked, CellState::Free) => Some(Event::Free),
            _ => None,
        }
    }
}

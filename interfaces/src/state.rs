use crate::Cell;

/// The state of a cell in the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Deserialize, serde::Serialize)]
pub enum CellState {
    /// Never observed.
    #[default]
    Unknown,
    /// No solid body is in the cell.
    Free,
    /// A solid body is in the cell.
    Blocked,
}

/// A change of a known cell (paper, section 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Deserialize, serde::Serialize)]
pub enum Event {
    /// From free to blocked.
    Block,
    /// From blocked to free.
    Free,
}

/// A change of the state of a cell in an update: a first observation, a change of a known cell, or the correction
/// of a first observation (the cell becomes unknown again, and then takes its true state).
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
pub struct Transition {
    /// The cell that changed.
    pub cell: Cell,
    /// The state before the change.
    pub before: CellState,
    /// The state after the change.
    pub after: CellState,
}

impl Transition {
    /// The change of a known cell; `None` for a first observation or its correction.
    pub fn event(&self) -> Option<Event> {
        match (self.before, self.after) {
            (CellState::Free, CellState::Blocked) => Some(Event::Block),
            (CellState::Blocked, CellState::Free) => Some(Event::Free),
            _ => None,
        }
    }
}

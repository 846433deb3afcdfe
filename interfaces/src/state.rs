use crate::Cell;

/// What the map says of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CellState {
    /// Never seen.
    #[default]
    Unknown,
    /// Nothing stands there.
    Free,
    /// Something stands there.
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

/// A cell that took another state in an update: a first sighting, a change, or a first sighting that
/// turned out wrong (the cell becomes unknown again, before it takes its right state).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transition {
    /// The cell.
    pub cell: Cell,
    /// What the map said before.
    pub before: CellState,
    /// What the map says now.
    pub after: CellState,
}

impl Transition {
    /// The change of a known cell; `None` for a first sighting, right or wrong.
    pub fn event(&self) -> Option<Event> {
        match (self.before, self.after) {
            (CellState::Free, CellState::Blocked) => Some(Event::Block),
            (CellState::Blocked, CellState::Free) => Some(Event::Free),
            _ => None,
        }
    }
}

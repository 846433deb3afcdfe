use interfaces::{CellState, Grid};
use mapper::Mapper;

/// A cell that changes is permanent in a state if it is in this state for at least this share of the time.
const PERMANENT: f64 = 0.9;

/// The map of what is permanent: a cell that never changed is as it was seen; a cell that changes is free where it is
/// free or will be free again, and blocked only where it is blocked nearly all the time. Movers, and their trails, are not
/// in this map.
pub fn permanent(mapper: &Mapper) -> Grid<CellState> {
    let mut map = mapper.states().clone();
    let changed: Vec<usize> = mapper.changed().collect();
    for index in changed {
        let share = share_blocked(mapper, index);
        map.cells_mut()[index] = if share >= PERMANENT { CellState::Blocked } else { CellState::Free };
    }
    map
}

/// The share of the time that a cell that changed is blocked, from 0 to 1: by its learned rates, or by the time in view
/// where there are no rates.
pub(crate) fn share_blocked(mapper: &Mapper, index: usize) -> f64 {
    if let Some((block, free)) = mapper.transition_rates(index).filter(|(block, free)| block + free > 0.0) {
        return block / (block + free);
    }
    let seen = mapper.statistics(index);
    let watched = seen.watched_free + seen.watched_blocked;
    match watched > 0.0 {
        true => seen.watched_blocked / watched,
        false => f64::from(u8::from(mapper.states().cells()[index] == CellState::Blocked)),
    }
}

use interfaces::{CellState, Grid, Transition};
use mapper::Mapper;
use std::f64::consts::LN_2;

/// The time between two searches for cells that are probably free again, in the time unit of the readings.
const SEARCH: f64 = 5.0;

/// The map on which paths are planned: the map as last seen, but a cell that was last seen blocked counts as unknown when
/// it probably was free since then. So a closed door is tried again, and the trail of a moving thing fades.
///
/// A cell that leaves the state blocked at the rate β was free at least once in a time t with probability 1 − e^(−βt).
/// The cell counts as unknown from probability 0.5 on, until it is observed again. A cell that never changed stays
/// blocked.
#[derive(Clone, Debug)]
pub(crate) struct PlanningMap {
    map: Grid<CellState>,
    /// The cells that count as unknown, by index.
    reopened: Vec<usize>,
    transitions: Vec<Transition>,
    searched_at: f64,
}

impl PlanningMap {
    /// The map as last seen.
    pub(crate) fn new(mapper: &Mapper) -> Self {
        let (reopened, transitions) = (Vec::new(), Vec::new());
        Self { map: mapper.states().clone(), reopened, transitions, searched_at: mapper.time() }
    }

    /// The map.
    pub(crate) fn map(&self) -> &Grid<CellState> {
        &self.map
    }

    /// The changes of this map in the last update. They contain the changes that the mapper found.
    pub(crate) fn transitions(&self) -> &[Transition] {
        &self.transitions
    }

    /// Applies the last reading of the mapper. Call it once per reading.
    pub(crate) fn update(&mut self, mapper: &Mapper) {
        self.transitions.clear();
        for Transition { cell, before, after } in mapper.transitions() {
            if let Some(index) = self.map.frame().index(*cell) {
                // A change of a cell that counted as unknown is still a change.
                self.change(index, *before);
                self.change(index, *after);
            }
        }
        let mut reopened = std::mem::take(&mut self.reopened);
        reopened.retain(|&index| {
            let state = mapper.states().cells()[index];
            let stays = state == CellState::Blocked && !mapper.is_in_view(index);
            if !stays {
                self.change(index, state);
            }
            stays
        });
        self.reopened = reopened;
        if mapper.time() >= self.searched_at + SEARCH {
            self.searched_at = mapper.time();
            self.reopen(mapper);
        }
    }

    fn reopen(&mut self, mapper: &Mapper) {
        for cell in mapper.changed() {
            let is_closed = self.map.cells()[cell] == CellState::Blocked && !mapper.is_in_view(cell);
            let opens = |(_, free): (f64, f64)| free * mapper.recency(cell) >= LN_2;
            if is_closed && mapper.transition_rates(cell).is_some_and(opens) {
                self.change(cell, CellState::Unknown);
                self.reopened.push(cell);
            }
        }
    }

    fn change(&mut self, index: usize, after: CellState) {
        let cell = self.map.frame().cell(index);
        let Some(state) = self.map.get_mut(cell) else { return };
        let before = std::mem::replace(state, after);
        if before != after {
            self.transitions.push(Transition { cell, before, after });
        }
    }
}

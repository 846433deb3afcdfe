use interfaces::{CellState, Grid, Transition};
use mapper::Mapper;

/// The time between two searches for cells that are probably free again, in the time unit of the readings.
const SEARCH: f64 = 5.0;
/// A cell that was last seen blocked counts as unknown up to this probability that it is blocked now.
const PASSABLE: f64 = 0.5;

/// The map on which paths are planned: the map as last seen, but a cell that was last seen blocked counts as unknown when
/// it is probably free now, by the rates of its changes, until it is observed again. So a closed door is tried again at a
/// rate that its openings suggest, and the trail of a moving thing fades. A cell that never changed stays blocked.
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
            if is_closed && mapper.blocked_probability(cell) <= PASSABLE {
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

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Cell, CellReading, GridFrame};
    use mapper::MapperSettings;
    use nalgebra::{Isometry2, Point2};

    const DOOR: Cell = Cell::new(1, 0);
    const WALL: Cell = Cell::new(2, 0);

    /// A mapper, and the map for planning on which every change was applied to `copy`.
    struct Planned {
        mapper: Mapper,
        planning: PlanningMap,
        copy: Grid<CellState>,
    }

    impl Planned {
        fn new() -> Self {
            let frame = GridFrame::new(Point2::origin(), 1.0, 3, 1).unwrap();
            let mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
            let planning = PlanningMap::new(&mapper);
            Self { copy: planning.map().clone(), mapper, planning }
        }

        fn see(&mut self, time: f64, mut cells: Vec<(Cell, bool)>) {
            cells.push((Cell::new(0, 0), false));
            self.mapper.update(&CellReading { time, pose: Isometry2::identity(), cells }).unwrap();
            self.planning.update(&self.mapper);
            for transition in self.planning.transitions() {
                let state = self.copy.get_mut(transition.cell).unwrap();
                assert_eq!(*state, transition.before);
                *state = transition.after;
            }
            assert_eq!(self.copy, *self.planning.map());
        }

        fn state(&self, cell: Cell) -> CellState {
            *self.planning.map().get(cell).unwrap()
        }
    }

    /// A door that is open for 20 s and closed for 10 s, watched for 10 minutes; closed at the end, and out of view
    /// from then on.
    fn out_of_sight_of_a_closed_door() -> Planned {
        let mut planned = Planned::new();
        for second in 0..=599 {
            planned.see(f64::from(second), vec![(DOOR, second % 30 >= 20), (WALL, true)]);
        }
        planned
    }

    #[test]
    fn a_closed_door_counts_as_unknown_when_it_is_probably_open_again_and_a_wall_never() {
        let mut planned = out_of_sight_of_a_closed_door();
        planned.see(601.0, Vec::new());
        assert_eq!(planned.state(DOOR), CellState::Blocked);
        for second in 602..700 {
            planned.see(f64::from(second), Vec::new());
        }
        assert_eq!([planned.state(DOOR), planned.state(WALL)], [CellState::Unknown, CellState::Blocked]);
    }

    #[test]
    fn what_is_seen_again_is_as_it_is_seen() {
        for closed in [true, false] {
            let mut planned = out_of_sight_of_a_closed_door();
            planned.see(700.0, Vec::new());
            assert_eq!(planned.state(DOOR), CellState::Unknown);
            planned.see(701.0, vec![(DOOR, closed)]);
            assert_eq!(planned.state(DOOR), if closed { CellState::Blocked } else { CellState::Free });
            let changes = planned.planning.transitions().iter().filter(|change| change.event().is_some());
            assert_eq!(changes.count(), usize::from(!closed));
        }
    }
}

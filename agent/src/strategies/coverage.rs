use super::best_trip::{Elapsed, Worth};
use interfaces::CellState;
use mapper::Mapper;

/// The worth of a look is the time since the last one: the strategy `coverage` goes where it sees most that it has not seen for
/// longest, per time.
#[derive(Clone, Copy, Debug)]
pub struct Age;

impl Worth for Age {
    fn name(&self) -> &'static str {
        "coverage"
    }

    fn of_looks(&self, mapper: &Mapper, elapsed: Elapsed, take: &mut dyn FnMut(usize, f64)) -> f64 {
        known(mapper).for_each(|cell| take(cell, elapsed(cell)));
        mapper.time()
    }
}

/// The cells of the map that were seen and can be goals.
pub(super) fn known(mapper: &Mapper) -> impl Iterator<Item = usize> {
    let states = mapper.states().cells().iter().enumerate();
    let seen = states.filter(|(_, state)| **state != CellState::Unknown).map(|(cell, _)| cell);
    seen.filter(|cell| mapper.is_candidate(*cell))
}

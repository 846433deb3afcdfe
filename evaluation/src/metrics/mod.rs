//! How right the robot is, against the truth of the world. Nothing here is known to the robot.
//!
//! A cell that solids cover in part is neither right nor wrong, and is left out at that moment.
//! Cells that can be seen are the free ones, and the blocked ones with a free side.

mod cells;
mod latency;
mod rates;
mod things;

pub use cells::{
    CellMapScores, CellRateScores, ChangingLooks, cell_map_scores, cell_rate_scores, false_change_events,
    log_error,
};
pub use latency::{Delays, Latency};
pub use rates::{RateScores, rate_scores};
pub use things::{ThingReport, Things};

use interfaces::CellState;
use interfaces::TrueState;
use mapper::Mapper;
use serde::Serialize;
use sim::physics::Truth;

/// How right the map is, as the metrics define it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scores {
    /// Share of the cells that can be seen that were seen.
    pub coverage: f64,
    /// Share of the cells that can be seen whose mapped state is true now.
    pub map_quality: f64,
}

/// How wrong the rates of change are, as the metrics define it; not a number while nothing has
/// changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateErrors {
    /// Mean of |estimate − truth| / truth over the cells that truly change.
    pub relative: f64,
    /// Mean of |ln(estimate / truth)|, cut to a factor of ten, per moving thing and then over the
    /// things.
    pub log: f64,
}

/// Whether the map says what is true; `None` where the cell is covered in part.
fn is_right(mapped: CellState, truth: TrueState) -> Option<bool> {
    match truth {
        TrueState::Free => Some(mapped == CellState::Free),
        TrueState::Blocked => Some(mapped == CellState::Blocked),
        TrueState::PartlyCovered => None,
    }
}

/// Coverage and map quality now, over the cells that can be seen.
pub fn scores(mapper: &Mapper, truth: &Truth) -> Scores {
    let (mut cells, mut seen, mut right) = (0, 0, 0);
    for (index, (&mapped, &true_state)) in mapper.states().cells().iter().zip(truth.states()).enumerate() {
        if !truth.can_be_seen(truth.frame().cell(index)) {
            continue;
        }
        cells += 1;
        seen += usize::from(mapper.was_ever_seen(index));
        right += usize::from(is_right(mapped, true_state) == Some(true));
    }
    let share = |count: usize| if cells == 0 { 1.0 } else { count as f64 / cells as f64 };
    Scores { coverage: share(seen), map_quality: share(right) }
}

/// Time since the cells that can be seen were seen, s.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Age {
    /// On average.
    pub mean_s: f64,
    /// At most.
    pub max_s: f64,
}

/// How old the map is now.
pub fn age(mapper: &Mapper, truth: &Truth) -> Age {
    let (mut cells, mut sum_s, mut max_s) = (0, 0.0, 0.0_f64);
    for index in (0..truth.frame().len()).filter(|&index| truth.can_be_seen(truth.frame().cell(index))) {
        cells += 1;
        sum_s += mapper.recency(index);
        max_s = max_s.max(mapper.recency(index));
    }
    Age { mean_s: sum_s / f64::from(cells.max(1)), max_s }
}

/// Map quality on the cells that truly change: the mean of the accuracy on the truly free and on
/// the truly blocked ones, counted at every call of [`Changing::count`].
#[derive(Clone, Debug, Default)]
pub struct Changing {
    /// For cells out of view and in view, for free and blocked: how many were right, of how many.
    counts: [[(u64, u64); 2]; 2],
}

/// Balanced accuracy on changing cells; `None` where there was nothing to count.
#[derive(Clone, Copy, Debug)]
pub struct ChangingScores {
    /// Of cells in view.
    pub in_view: Option<f64>,
    /// Of cells out of view.
    pub out_of_view: Option<f64>,
}

impl Changing {
    /// Counts the changing cells as they are now. Unknown cells, and blocked ones that no side
    /// shows, are left out.
    pub fn count(&mut self, mapper: &Mapper, truth: &Truth) {
        for (index, mover) in truth.movers().iter().enumerate() {
            let mapped = mapper.states().cells()[index];
            if mover.is_none()
                || mapped == CellState::Unknown
                || !truth.can_be_seen(truth.frame().cell(index))
            {
                continue;
            }
            if let Some(is_right) = is_right(mapped, truth.states()[index]) {
                let view = usize::from(mapper.is_in_view(index));
                let blocked = usize::from(truth.states()[index] == TrueState::Blocked);
                let (right, all) = &mut self.counts[view][blocked];
                *right += u64::from(is_right);
                *all += 1;
            }
        }
    }

    /// The scores over all that was counted.
    pub fn scores(&self) -> ChangingScores {
        let balanced = |[free, blocked]: [(u64, u64); 2]| {
            let share = |(right, all): (u64, u64)| (all > 0).then(|| right as f64 / all as f64);
            Some((share(free)? + share(blocked)?) / 2.0)
        };
        ChangingScores { in_view: balanced(self.counts[1]), out_of_view: balanced(self.counts[0]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{CellReading, Grid};
    use mapper::MapperSettings;
    use sim::physics::PhysicsWorld;

    fn world() -> PhysicsWorld {
        let text = include_str!("../../../worlds/four_rooms.toml");
        PhysicsWorld::new(&sim::physics::WorldSpec::parse("four_rooms.toml", text).unwrap(), 0)
    }

    /// The map that says what is true, and what `otherwise` where a cell is covered in part.
    fn true_map(truth: &Truth, otherwise: CellState) -> Grid<CellState> {
        let state = |state: &TrueState| match state {
            TrueState::Free => CellState::Free,
            TrueState::Blocked => CellState::Blocked,
            TrueState::PartlyCovered => otherwise,
        };
        Grid::from_cells(*truth.frame(), truth.states().iter().map(state).collect()).unwrap()
    }

    #[test]
    fn the_true_map_is_right_and_the_empty_one_is_not() {
        let world = world();
        for otherwise in [CellState::Free, CellState::Blocked, CellState::Unknown] {
            let map = true_map(world.truth(), otherwise);
            let known = Mapper::with_prior(&MapperSettings::default(), map).unwrap();
            assert_eq!(scores(&known, world.truth()), Scores { coverage: 0.0, map_quality: 1.0 });
        }
        let unknown = Mapper::new(&MapperSettings::default(), *world.truth().frame()).unwrap();
        assert_eq!(scores(&unknown, world.truth()), Scores::default());
    }

    #[test]
    fn coverage_and_age_count_the_cells_that_can_be_seen() {
        let world = world();
        let truth = world.truth();
        let visible: Vec<_> = (0..truth.frame().len())
            .map(|i| truth.frame().cell(i))
            .filter(|&c| truth.can_be_seen(c))
            .collect();
        let mut mapper = Mapper::new(&MapperSettings::default(), *truth.frame()).unwrap();
        let half = visible.len() / 2;
        for (time, seen) in [(10.0, &visible[..half]), (30.0, &visible[..0])] {
            let cells = seen.iter().map(|&cell| (cell, truth.state(cell) == Some(TrueState::Blocked)));
            let reading = CellReading { time, pose: *world.true_pose(), cells: cells.collect() };
            mapper.update(&reading).unwrap();
        }
        let share = half as f64 / visible.len() as f64;
        assert_eq!(scores(&mapper, truth), Scores { coverage: share, map_quality: share });
        let Age { mean_s, max_s } = age(&mapper, truth);
        assert_eq!(max_s, 30.0);
        assert!((mean_s - (20.0 * share + 30.0 * (1.0 - share))).abs() < 1e-9, "{mean_s}");
    }
}

//! How right a mind is about a grid world, whose truth is known cell by cell.

use interfaces::CellState;
use interfaces::GroundTruth;
use mapper::Mapper;
use sim::grid::GridTruth;

/// Where the log error is cut: a factor of ten either way.
const MAX_FACTOR: f64 = 10.0;

/// The rates against those that really happened so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellRateScores {
    /// Mean of |estimate − truth| / truth over the cells that truly changed; no estimate counts as
    /// 0. NaN before anything changed.
    pub rate_error: f64,
    /// Mean of min(|ln(estimate / truth)|, ln 10) over these cells, averaged per moving thing first,
    /// then over the things; no estimate counts as ln 10. NaN before anything changed.
    pub log_error: f64,
    /// Mean estimated cycle rate over the observed cells that no moving thing ever touches, per step.
    pub false_rate: f64,
}

/// Compares the rates of `mapper` with what really happened.
pub fn cell_rate_scores(mapper: &Mapper, truth: &GridTruth) -> CellRateScores {
    let mut relative = Average::default();
    for &index in truth.swept() {
        let true_rate = truth.cycle_rate(index);
        if true_rate > 0.0 {
            relative.add((mapper.rate(index) - true_rate).abs() / true_rate);
        }
    }
    let mut things = Average::default();
    for thing in truth.moving_things().iter() {
        let mut cells = Average::default();
        for &index in thing {
            let true_rate = truth.cycle_rate(index);
            if true_rate > 0.0 {
                cells.add(log_error(mapper.rate(index), true_rate));
            }
        }
        things.add_mean(&cells);
    }
    let mut still = Average::default();
    for index in 0..mapper.frame().len() {
        if !truth.is_swept(index) && mapper.was_ever_seen(index) {
            still.add(mapper.rate(index));
        }
    }
    CellRateScores { rate_error: relative.mean(), log_error: things.mean(), false_rate: still.mean_or(0.0) }
}

/// min(|ln(estimate / truth)|, ln 10); no estimate counts as ln 10.
pub fn log_error(estimate: f64, truth: f64) -> f64 {
    let most = libm::log(MAX_FACTOR);
    if estimate > 0.0 { libm::log(estimate / truth).abs().min(most) } else { most }
}

/// Change events counted on cells that no moving thing ever touches.
pub fn false_change_events(mapper: &Mapper, truth: &GridTruth) -> u64 {
    let still = mapper.changed().filter(|&index| !truth.is_swept(index));
    still.map(|index| u64::from(mapper.statistics(index).events())).sum()
}

/// The map against the truth now.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellMapScores {
    /// Share of the cells that can be seen that were seen.
    pub coverage: f64,
    /// Share of the cells that can be seen whose mapped state is true; unknown is wrong.
    pub map_quality: f64,
}

/// Compares the map with the truth now.
pub fn cell_map_scores(mapper: &Mapper, truth: &GridTruth) -> CellMapScores {
    let (mut seen, mut right) = (Average::default(), Average::default());
    for index in 0..mapper.frame().len() {
        if truth.can_be_seen(index) {
            seen.add_if(mapper.was_ever_seen(index));
            right.add_if(is_right(mapper, truth, index));
        }
    }
    CellMapScores { coverage: seen.mean_or(0.0), map_quality: right.mean_or(0.0) }
}

fn is_right(mapper: &Mapper, truth: &GridTruth, index: usize) -> bool {
    let state = if truth.is_blocked(index) { CellState::Blocked } else { CellState::Free };
    mapper.states().cells()[index] == state
}

/// How right a mind was about the changing cells over a while. They are few, and all of them can be
/// right or wrong at one instant, so what counts is the mean over many looks.
#[derive(Clone, Copy, Debug, Default)]
pub struct ChangingLooks {
    /// Whether the map was right, on truly free and on truly blocked cells.
    right: [Average; 2],
    model: Average,
    last_seen: Average,
    mean: Average,
}

/// What [`ChangingLooks`] came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChangingScores {
    /// The mean of the accuracy of the map on truly free and on truly blocked cells. NaN without
    /// changing cells.
    pub map_quality: f64,
    /// Brier score (the mean square of prediction minus truth; less is better) of P(blocked now) for
    /// cells out of view by the two-state model, [`Mapper::blocked_probability`]. NaN where all cells
    /// were always in view.
    pub brier: f64,
    /// The same of the state last seen; 0.5 for a cell never seen.
    pub brier_last_seen: f64,
    /// The same of the share of its time in view that the cell was blocked.
    pub brier_mean: f64,
}

impl ChangingLooks {
    /// Looks at what `mapper` believes now.
    pub fn look(&mut self, mapper: &Mapper, truth: &GridTruth) {
        for &index in truth.swept() {
            let is_blocked = truth.is_blocked(index);
            self.right[usize::from(is_blocked)].add_if(is_right(mapper, truth, index));
            if mapper.is_in_view(index) {
                continue;
            }
            let now = f64::from(u8::from(is_blocked));
            let square = |prediction: f64| (prediction - now) * (prediction - now);
            let state = match mapper.states().cells()[index] {
                CellState::Unknown => 0.5,
                CellState::Free => 0.0,
                CellState::Blocked => 1.0,
            };
            let seen = mapper.statistics(index);
            let watched = seen.watched_free + seen.watched_blocked;
            self.model.add(square(mapper.blocked_probability(index)));
            self.last_seen.add(square(state));
            self.mean.add(square(if watched > 0.0 { seen.watched_blocked / watched } else { state }));
        }
    }

    /// What it came to.
    pub fn scores(&self) -> ChangingScores {
        let mut balanced = Average::default();
        self.right.iter().for_each(|accuracy| balanced.add_mean(accuracy));
        ChangingScores {
            map_quality: balanced.mean(),
            brier: self.model.mean(),
            brier_last_seen: self.last_seen.mean(),
            brier_mean: self.mean.mean(),
        }
    }
}

/// A running mean.
#[derive(Clone, Copy, Debug, Default)]
struct Average {
    sum: f64,
    count: u32,
}

impl Average {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    fn add_if(&mut self, is: bool) {
        self.add(f64::from(u8::from(is)));
    }

    /// The mean of another as one value; nothing if that has none.
    fn add_mean(&mut self, other: &Self) {
        if other.count > 0 {
            self.add(other.mean());
        }
    }

    /// NaN of nothing.
    fn mean(&self) -> f64 {
        self.sum / f64::from(self.count)
    }

    fn mean_or(&self, nothing: f64) -> f64 {
        if self.count > 0 { self.mean() } else { nothing }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Cell, CellReading, Step, World};
    use mapper::{Estimator, MapperSettings};
    use nalgebra::Isometry2;
    use sim::grid::{GridSpec, GridWorld};

    /// A block that moves every step over three cells, and another that moves every 50 over two.
    const WORLD: &str = r##"
        name = "shelf"
        sensor_radius = 1
        map = """
        #######
        #.....#
        #..R..#
        #######
        """
        [[block]]
        name = "fast"
        dwell = 1
        course = "back-and-forth"
        path = [[1, 2], [3, 2]]
        [[block]]
        name = "slow"
        dwell = 50
        course = "back-and-forth"
        path = [[4, 2], [5, 2]]
    "##;

    fn world() -> GridWorld {
        let unindented: String = WORLD.lines().map(|line| line.trim_start().to_owned() + "\n").collect();
        GridWorld::new(&GridSpec::parse("shelf.toml", &unindented).unwrap(), 0)
    }

    fn mapper(world: &GridWorld) -> Mapper {
        let settings = MapperSettings { estimator: Estimator::Paper, ..Default::default() };
        Mapper::new(&settings, *world.truth().frame()).unwrap()
    }

    /// Shows `mapper` the true state of the cells that `sees` picks.
    fn show(world: &GridWorld, mapper: &mut Mapper, sees: impl Fn(Cell) -> bool) {
        let truth = world.truth();
        let cells =
            (0..truth.frame().len()).map(|index| (truth.frame().cell(index), truth.is_blocked(index)));
        let cells = cells.filter(|&(cell, _)| sees(cell)).collect();
        mapper.update(&CellReading { time: truth.elapsed(), pose: Isometry2::identity(), cells }).unwrap();
    }

    #[test]
    fn who_sees_everything_is_right() {
        let mut world = world();
        let mut mapper = mapper(&world);
        assert!(cell_rate_scores(&mapper, world.truth()).log_error.is_nan(), "nothing changed yet");
        for _ in 0..40 {
            show(&world, &mut mapper, |_| true);
            world.act(&Step::Stay);
        }
        show(&world, &mut mapper, |_| true);
        let scores = cell_rate_scores(&mapper, world.truth());
        assert_eq!((scores.rate_error, scores.log_error, scores.false_rate), (0.0, 0.0, 0.0));
        assert_eq!(false_change_events(&mapper, world.truth()), 0);
        assert_eq!(
            cell_map_scores(&mapper, world.truth()),
            CellMapScores { coverage: 1.0, map_quality: 1.0 }
        );
        let mut looks = ChangingLooks::default();
        looks.look(&mapper, world.truth());
        assert_eq!(looks.scores().map_quality, 1.0);
        assert!(looks.scores().brier.is_nan(), "nothing is out of view");
    }

    #[test]
    fn who_sees_nothing_is_wrong_by_definition() {
        let mut world = world();
        let mapper = mapper(&world);
        (0..60).for_each(|_| world.act(&Step::Stay));
        let scores = cell_rate_scores(&mapper, world.truth());
        assert_eq!(scores.rate_error, 1.0);
        assert!((scores.log_error - 10.0_f64.ln()).abs() < 1e-12);
        assert_eq!(
            cell_map_scores(&mapper, world.truth()),
            CellMapScores { coverage: 0.0, map_quality: 0.0 }
        );
        let mut looks = ChangingLooks::default();
        looks.look(&mapper, world.truth());
        let scores = looks.scores();
        assert_eq!((scores.map_quality, scores.brier, scores.brier_last_seen), (0.0, 0.25, 0.25));
    }

    #[test]
    fn things_count_alike_however_many_cells_they_have() {
        let mut world = world();
        let mut mapper = mapper(&world);
        for _ in 0..120 {
            show(&world, &mut mapper, |cell| cell.x < 4);
            world.act(&Step::Stay);
        }
        // All is known of the fast block's three cells, nothing of the slow one's two.
        let scores = cell_rate_scores(&mapper, world.truth());
        assert!((scores.log_error - 10.0_f64.ln() / 2.0).abs() < 0.02, "{scores:?}");
        assert!((scores.rate_error - 2.0 / 5.0).abs() < 0.02, "{scores:?}");
    }

    #[test]
    fn a_map_that_is_out_of_date_is_wrong_where_things_have_moved() {
        let mut world = world();
        let mut mapper = mapper(&world);
        show(&world, &mut mapper, |_| true);
        world.act(&Step::Stay);
        show(&world, &mut mapper, |cell| cell.y == 0);
        let visible = (0..28).filter(|&index| world.truth().can_be_seen(index)).count() as f64;
        let scores = cell_map_scores(&mapper, world.truth());
        assert!((scores.map_quality - (visible - 2.0) / visible).abs() < 1e-12, "{scores:?}");
        let mut looks = ChangingLooks::default();
        looks.look(&mapper, world.truth());
        // Of three free changing cells two are right, of two blocked ones one.
        assert_eq!(looks.scores().map_quality, (2.0 / 3.0 + 0.5) / 2.0);
        assert_eq!(looks.scores().brier_last_seen, 2.0 / 5.0);
    }
}

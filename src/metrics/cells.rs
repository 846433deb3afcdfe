//! How right a mind is about a grid world, whose truth is known cell by cell.

use geometry::CellState;
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
    for thing in truth.things() {
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
    /// For the changing cells alone the mean of the accuracy on truly free and on truly blocked
    /// ones. NaN without changing cells.
    pub map_quality_changing: f64,
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
    let mut changing = [Average::default(); 2];
    for &index in truth.swept() {
        changing[usize::from(truth.is_blocked(index))].add_if(is_right(mapper, truth, index));
    }
    let mut balanced = Average::default();
    changing.iter().for_each(|accuracy| balanced.add_mean(accuracy));
    CellMapScores {
        coverage: seen.mean_or(0.0),
        map_quality: right.mean_or(0.0),
        map_quality_changing: balanced.mean(),
    }
}

fn is_right(mapper: &Mapper, truth: &GridTruth, index: usize) -> bool {
    let state = if truth.is_blocked(index) { CellState::Blocked } else { CellState::Free };
    mapper.states().cells()[index] == state
}

/// Brier scores of P(blocked now) over the changing cells that are out of view: the mean square of
/// prediction minus truth. Lower is better; NaN where all changing cells are in view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictionScores {
    /// Of the two-state model, [`Mapper::blocked_probability`].
    pub model: f64,
    /// Of the state last seen; 0.5 for a cell never seen.
    pub last_seen: f64,
    /// Of the share of its time in view that the cell was blocked; 0.5 for a cell never watched.
    pub mean: f64,
}

/// Judges what `mapper` believes of the changing cells that it does not see now.
pub fn prediction_scores(mapper: &Mapper, truth: &GridTruth) -> PredictionScores {
    let [mut model, mut last_seen, mut mean] = [Average::default(); 3];
    for &index in truth.swept() {
        if mapper.is_in_view(index) {
            continue;
        }
        let now = f64::from(u8::from(truth.is_blocked(index)));
        let square = |prediction: f64| (prediction - now) * (prediction - now);
        let state = match mapper.states().cells()[index] {
            CellState::Unknown => 0.5,
            CellState::Free => 0.0,
            CellState::Blocked => 1.0,
        };
        let statistics = mapper.statistics(index);
        let watched = statistics.watched_free + statistics.watched_blocked;
        model.add(square(mapper.blocked_probability(index)));
        last_seen.add(square(state));
        mean.add(square(if watched > 0.0 { statistics.watched_blocked / watched } else { state }));
    }
    PredictionScores { model: model.mean(), last_seen: last_seen.mean(), mean: mean.mean() }
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

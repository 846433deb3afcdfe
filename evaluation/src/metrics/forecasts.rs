//! Forecasts of a run: the map is frozen now and then, and compared with the truth some time later.

use super::deviance::{DevianceScores, FrozenRates};
use super::mean::Mean;
use super::prediction::share_blocked;
use super::{ProbabilityScores, TrueChains};
use interfaces::{CellState, GroundTruth, TrueState};
use mapper::Mapper;
use serde::{Deserialize, Serialize};

/// The first time at which the rates are frozen, s (steps in a grid world), and the factor from one time to the next: 400 s,
/// 20 minutes and 1 hour are among the times, so that runs of 20 minutes and of 1 hour end with a forecast.
const FIRST_FREEZE: f64 = 400.0 / 27.0;
const FACTOR: f64 = 3.0;
/// How far ahead the states of cells are predicted, s (steps in a grid world): 1 minute, 10 minutes, 1 hour.
const HORIZONS: [f64; 3] = [60.0, 600.0, 3600.0];
/// A prediction is scored up to this share of the horizon after its time: a robot that rests has no readings, and the prediction was
/// not for the end of the rest.
const LATE: f64 = 0.05;
/// Times are sums of steps of a physics world, s.
const SLACK: f64 = 1e-6;

/// The forecasts of a run so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Forecasts {
    /// The rates frozen last, and the time at which they are scored and frozen again.
    rates: FrozenRates,
    due: Option<f64>,
    scores: DevianceScores,
    ahead: [Lookahead; 3],
}

/// The quality of forecasts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ForecastScores {
    /// How well the rates predicted the events between the last two times of 400 s, 20 minutes, 1 hour, and so on (also
    /// before: a third, a ninth, a 27th of 400 s).
    pub rates: DevianceScores,
    /// The predicted map, 1 minute ahead.
    pub states_1min: StateScores,
    /// The predicted map, 10 minutes ahead.
    pub states_10min: StateScores,
    /// The predicted map, 1 hour ahead.
    pub states_1h: StateScores,
}

/// The quality of the predicted map over swept cells that were known and free, or had changed, when the map was frozen;
/// cells that are partly covered when the time has come are left out. A prediction without a reading at its time, or at most 5 %
/// of the horizon later, is left out, as those that end while a robot rests. All are `None` before the end of a forecast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StateScores {
    /// The Brier score of P(blocked): the mean of (prediction − truth)².
    pub brier: Option<f64>,
    /// The Brier score of the state that was last seen.
    pub brier_last_seen: Option<f64>,
    /// The Brier score of the share of the time in view during which the cell was blocked; of the state that was last
    /// seen if the cell was not in view for any time.
    pub brier_mean: Option<f64>,
    /// The Brier score of a Markov chain with the true rates and the true share of the time that the cell is blocked, up to the
    /// freeze, after the same observations. `None` where it was not measured.
    pub brier_true_chains: Option<f64>,
    /// The expected calibration error of P(blocked): the mean distance of the predicted from the true share of blocked
    /// cells in ten classes of predictions, by the number of predictions in each.
    pub calibration_error: Option<f64>,
}

impl Forecasts {
    /// Observes one reading. `chains` are the true chains, if they are to be compared.
    pub fn observe(&mut self, mapper: &Mapper, truth: &impl GroundTruth, chains: Option<&TrueChains>) {
        let now = truth.elapsed() + SLACK;
        let mut due = self.due.unwrap_or(FIRST_FREEZE);
        if now >= due {
            if self.due.is_some() {
                self.scores = self.rates.scores(truth);
            }
            self.rates = FrozenRates::of(mapper, truth);
            while now >= due {
                due *= FACTOR;
            }
            self.due = Some(due);
        }
        for (ahead, horizon) in self.ahead.iter_mut().zip(HORIZONS) {
            ahead.observe(horizon, mapper, truth, chains);
        }
    }

    /// The scores so far.
    pub fn scores(&self) -> ForecastScores {
        let [states_1min, states_10min, states_1h] = self.ahead.each_ref().map(Lookahead::scores);
        ForecastScores { rates: self.scores, states_1min, states_10min, states_1h }
    }

    /// Whether nothing was frozen yet.
    pub fn is_empty(&self) -> bool {
        self.due.is_none()
    }
}

/// The predicted states of cells at a fixed time after the map was frozen, one forecast after the other.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Lookahead {
    due: Option<f64>,
    cells: Vec<FrozenState>,
    predicted: ProbabilityScores,
    last_seen: Mean,
    average: Mean,
    true_chains: Mean,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct FrozenState {
    index: u32,
    is_blocked: bool,
    predicted: f32,
    average: f32,
    true_chain: Option<f32>,
}

impl Lookahead {
    fn observe(
        &mut self,
        horizon: f64,
        mapper: &Mapper,
        truth: &impl GroundTruth,
        chains: Option<&TrueChains>,
    ) {
        let (now, due) = (truth.elapsed(), self.due.unwrap_or(horizon));
        if now + SLACK < due {
            return;
        }
        let is_late = now > due + LATE * horizon + SLACK;
        for cell in std::mem::take(&mut self.cells).into_iter().filter(|_| !is_late) {
            let index = cell.index as usize;
            if truth.is_swept(index) && truth.state(index) != TrueState::PartlyCovered {
                self.score(cell, truth.state(index) == TrueState::Blocked);
            }
        }
        let states = mapper.states().cells().iter().enumerate();
        let may_change = |&(index, state): &(usize, &CellState)| {
            *state == CellState::Free || *state == CellState::Blocked && mapper.statistics(index).events() > 0
        };
        let frozen = states.filter(may_change).map(|(index, state)| {
            let (is_blocked, elapsed) = (*state == CellState::Blocked, mapper.recency(index) + horizon);
            let last_seen = f64::from(u8::from(is_blocked));
            FrozenState {
                index: index as u32,
                is_blocked,
                predicted: mapper.blocked_probability_later(index, horizon) as f32,
                average: share_blocked(mapper, index).unwrap_or(last_seen) as f32,
                true_chain: chains
                    .map(|chains| chains.blocked_probability(truth, index, last_seen, elapsed) as f32),
            }
        });
        self.cells = frozen.collect();
        self.due = Some(now + horizon);
    }

    fn score(&mut self, cell: FrozenState, is_blocked: bool) {
        let square = |predicted: f64| (predicted - f64::from(u8::from(is_blocked))).powi(2);
        self.predicted.add(f64::from(cell.predicted), is_blocked);
        self.last_seen.add(square(f64::from(u8::from(cell.is_blocked))));
        self.average.add(square(f64::from(cell.average)));
        if let Some(predicted) = cell.true_chain {
            self.true_chains.add(square(f64::from(predicted)));
        }
    }

    fn scores(&self) -> StateScores {
        StateScores {
            brier: self.predicted.brier(),
            brier_last_seen: self.last_seen.get(),
            brier_mean: self.average.get(),
            brier_true_chains: self.true_chains.get(),
            calibration_error: self.predicted.calibration_error(),
        }
    }
}

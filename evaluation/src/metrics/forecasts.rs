//! Forecasts of a run: the map is frozen now and then, and compared with the truth some time later.

use super::TrueChains;
use super::deviance::{DevianceScores, FrozenRates};
use super::prediction::{PredictedState, Prediction, StateScores};
use interfaces::{CellState, GroundTruth};
use mapper::Mapper;
use serde::{Deserialize, Serialize};

/// The first time at which the rates are frozen, s (steps in a grid world), and the factor from one time to the next: 400 s,
/// 20 minutes and 1 hour are among the times, so that runs of 20 minutes and of 1 hour end with a forecast.
const FIRST_FREEZE: f64 = 400.0 / 27.0;
const FACTOR: f64 = 3.0;
/// How far ahead the states of cells are predicted, s (steps in a grid world): 1 minute, 10 minutes, 1 hour.
const HORIZONS: [f64; 3] = [60.0, 600.0, 3600.0];
/// A prediction is scored up to this share of the horizon after its time, and otherwise left out: a robot that rests has no readings, and the prediction was
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
        let [states_1min, states_10min, states_1h] =
            self.ahead.each_ref().map(|ahead| ahead.prediction.scores());
        ForecastScores { rates: self.scores, states_1min, states_10min, states_1h }
    }
}

/// The predicted states of cells at a fixed time after the map was frozen, one forecast after the other.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Lookahead {
    due: Option<f64>,
    cells: Vec<(u32, PredictedState)>,
    prediction: Prediction,
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
        for (index, predicted) in std::mem::take(&mut self.cells).into_iter().filter(|_| !is_late) {
            if truth.is_swept(index as usize) {
                self.prediction.add(&predicted, truth.state(index as usize));
            }
        }
        let states = mapper.states().cells().iter().enumerate();
        let may_change = |&(index, state): &(usize, &CellState)| {
            *state == CellState::Free || *state == CellState::Blocked && mapper.statistics(index).events() > 0
        };
        let frozen = |index| (index as u32, PredictedState::of(mapper, truth, index, horizon, chains));
        self.cells = states.filter(may_change).map(|(index, _)| frozen(index)).collect();
        self.due = Some(now + horizon);
    }
}

//! How well the map predicts the states of cells.

use super::deviance::{DevianceScores, FrozenRates};
use super::statistics::Mean;
use super::{ProbabilityScores, TrueChains};
use interfaces::{CellState, GroundTruth, TrueState};
use mapper::Mapper;
use serde::{Deserialize, Serialize};

/// The probability that a cell is blocked, as predicted, and by simpler predictions.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
pub(super) struct PredictedState {
    model: f64,
    last_seen: f64,
    average: f64,
    true_chain: Option<f64>,
}

impl PredictedState {
    /// The prediction for a time after the last reading. `chains` are the true chains, if they are to be compared.
    pub(super) fn of(
        mapper: &Mapper,
        truth: &impl GroundTruth,
        index: usize,
        ahead: f64,
        chains: Option<&TrueChains>,
    ) -> Self {
        let last_seen = match mapper.states().cells()[index] {
            CellState::Unknown => 0.5,
            CellState::Free => 0.0,
            CellState::Blocked => 1.0,
        };
        let of_chain = |chains: &TrueChains| match mapper.states().cells()[index] {
            CellState::Unknown => last_seen,
            _ => chains.blocked_probability(truth, index, last_seen, mapper.recency(index) + ahead),
        };
        let true_chain = chains.map(of_chain);
        if !mapper.has_changed(index) {
            return Self { model: last_seen, last_seen, average: last_seen, true_chain };
        }
        let seen = mapper.statistics(index);
        let watched = seen.watched_free + seen.watched_blocked;
        let average = if watched > 0.0 { seen.watched_blocked / watched } else { last_seen };
        Self { model: mapper.blocked_probability_later(index, ahead), last_seen, average, true_chain }
    }
}

/// The quality of predicted states of swept cells so far.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
pub struct Prediction {
    model: ProbabilityScores,
    last_seen: Mean,
    average: Mean,
    true_chains: Mean,
}

/// The quality of predicted states. A Brier score is the mean of (predicted probability of "blocked" − truth)²; lower is better. All
/// are `None` without a prediction. Predictions are for swept cells that are not partly covered then: those out of view at the
/// moment; in a forecast, those that were known and free, or had changed, when the map was frozen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StateScores {
    /// The Brier score of the map as predicted, [`Mapper::blocked_probability`].
    pub brier: Option<f64>,
    /// The Brier score of the state that was last seen; 0.5 for a cell that was never seen.
    pub brier_last_seen: Option<f64>,
    /// The Brier score of the share of the time in view during which the cell was blocked; of the state that was last
    /// seen if the cell was not in view for any time.
    pub brier_mean: Option<f64>,
    /// The Brier score of a Markov chain with the true rates so far and the true share of the time that the cell is
    /// blocked, after the same observations; 0.5 for a cell that was never seen. `None` where it was not measured.
    pub brier_true_chains: Option<f64>,
    /// The expected calibration error of the map as predicted: the mean distance of the predicted from the true share of blocked
    /// cells in ten classes of predictions, by the number of predictions in each.
    pub calibration_error: Option<f64>,
}

impl Prediction {
    /// Compares the predictions for the swept cells that are `chosen` with the ground truth now.
    pub fn sample(
        &mut self,
        mapper: &Mapper,
        truth: &impl GroundTruth,
        chains: Option<&TrueChains>,
        chosen: impl Fn(usize) -> bool,
    ) {
        for &index in truth.swept().iter().filter(|index| chosen(**index)) {
            self.add(&PredictedState::of(mapper, truth, index, 0.0, chains), truth.state(index));
        }
    }

    /// Compares a prediction with the true state. A partly covered cell is ignored.
    pub(super) fn add(&mut self, predicted: &PredictedState, truth: TrueState) {
        if truth == TrueState::PartlyCovered {
            return;
        }
        let is_blocked = truth == TrueState::Blocked;
        let square = |probability: f64| (probability - f64::from(u8::from(is_blocked))).powi(2);
        self.model.add(predicted.model, is_blocked);
        self.last_seen.add(square(predicted.last_seen));
        self.average.add(square(predicted.average));
        if let Some(of_chain) = predicted.true_chain {
            self.true_chains.add(square(of_chain));
        }
    }

    /// The scores over all samples.
    pub fn scores(&self) -> StateScores {
        StateScores {
            brier: self.model.brier(),
            brier_last_seen: self.last_seen.get(),
            brier_mean: self.average.get(),
            brier_true_chains: self.true_chains.get(),
            calibration_error: self.model.calibration_error(),
        }
    }
}

// Forecasts of a run: the map is frozen now and then, and compared with the truth some time later.

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
            *state == CellState::Free || *state == CellState::Blocked && mapper.has_changed(index)
        };
        let frozen = |index| (index as u32, PredictedState::of(mapper, truth, index, horizon, chains));
        self.cells = states.filter(may_change).map(|(index, _)| frozen(index)).collect();
        self.due = Some(now + horizon);
    }
}

//! How well the map predicts the states of cells.

use super::mean::Mean;
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
        let seen = mapper.statistics(index);
        let watched = seen.watched_free + seen.watched_blocked;
        Self {
            model: mapper.blocked_probability_later(index, ahead),
            last_seen,
            average: if watched > 0.0 { seen.watched_blocked / watched } else { last_seen },
            true_chain: chains.map(of_chain),
        }
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

use super::TrueChains;
use super::mean::Mean;
use interfaces::{CellState, GroundTruth, TrueState};
use mapper::Mapper;
use serde::Serialize;

/// The quality of the prediction of the state of swept cells out of view, sampled over a part of a run.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct Prediction {
    model: Mean,
    last_seen: Mean,
    average: Mean,
    true_chains: Mean,
    /// The accuracy on truly free and on truly blocked cells.
    correct: [Mean; 2],
}

/// The quality of the predicted map on swept cells that are out of view. The Brier score is the mean of (predicted
/// probability of "blocked now" − truth)²; lower is better. All are `None` if all swept cells were always in view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PredictedScores {
    /// The mean of the accuracy on truly free cells and the accuracy on truly blocked cells, for known cells that can
    /// be seen: is the more probable state the true one? `None` unless there are free and blocked ones.
    pub balanced_accuracy_out_of_view: Option<f64>,
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
}

impl Prediction {
    /// Compares the predictions for swept cells out of view with the ground truth now. Partly covered cells are
    /// ignored. `chains` are the true chains, if they are to be compared.
    pub fn sample(&mut self, mapper: &Mapper, truth: &impl GroundTruth, chains: Option<&TrueChains>) {
        for &index in truth.swept().iter().filter(|&&index| !mapper.is_in_view(index)) {
            let is_blocked = match truth.state(index) {
                TrueState::PartlyCovered => continue,
                state => state == TrueState::Blocked,
            };
            let mapped = mapper.states().cells()[index];
            let last_seen = match mapped {
                CellState::Unknown => 0.5,
                CellState::Free => 0.0,
                CellState::Blocked => 1.0,
            };
            let average = share_blocked(mapper, index).unwrap_or(last_seen);
            let model = mapper.blocked_probability(index);
            let square = |prediction: f64| {
                let error = prediction - f64::from(u8::from(is_blocked));
                error * error
            };
            self.model.add(square(model));
            self.last_seen.add(square(last_seen));
            self.average.add(square(average));
            if let Some(chains) = chains {
                let is_known = mapped != CellState::Unknown;
                let of_chain = || chains.blocked_probability(truth, index, last_seen, mapper.recency(index));
                self.true_chains.add(square(if is_known { of_chain() } else { last_seen }));
            }
            if mapped != CellState::Unknown && truth.can_be_seen(index) {
                self.correct[usize::from(is_blocked)].add_bool((model > 0.5) == is_blocked);
            }
        }
    }

    /// The scores over all samples.
    pub fn scores(&self) -> PredictedScores {
        let [free, blocked] = self.correct.map(|accuracy| accuracy.get());
        PredictedScores {
            balanced_accuracy_out_of_view: free.zip(blocked).map(|(free, blocked)| (free + blocked) / 2.0),
            brier: self.model.get(),
            brier_last_seen: self.last_seen.get(),
            brier_mean: self.average.get(),
            brier_true_chains: self.true_chains.get(),
        }
    }
}

/// The Brier score of the predicted map over all swept cells, in view or not, sampled over a part of a run: how fresh the map is.
#[derive(Clone, Copy, Debug, Default)]
pub struct BrierOfAll(Mean);

impl BrierOfAll {
    /// Compares the prediction for every swept cell with the ground truth now. Partly covered cells are ignored.
    pub fn sample(&mut self, mapper: &Mapper, truth: &impl GroundTruth) {
        for &index in truth.swept().iter() {
            let is_blocked = match truth.state(index) {
                TrueState::PartlyCovered => continue,
                state => state == TrueState::Blocked,
            };
            let error = mapper.blocked_probability(index) - f64::from(u8::from(is_blocked));
            self.0.add(error * error);
        }
    }

    /// The score over all samples; `None` without a swept cell.
    pub fn get(&self) -> Option<f64> {
        self.0.get()
    }
}

/// The share of the time in view during which a cell was blocked; `None` if the cell was not in view for any time.
pub(super) fn share_blocked(mapper: &Mapper, index: usize) -> Option<f64> {
    let seen = mapper.statistics(index);
    let watched = seen.watched_free + seen.watched_blocked;
    (watched > 0.0).then(|| seen.watched_blocked / watched)
}

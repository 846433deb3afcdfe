use super::mean::Mean;
use interfaces::{CellState, GroundTruth, TrueState};
use mapper::Mapper;

/// How well the state of swept cells out of view is predicted, sampled over a part of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Prediction {
    model: Mean,
    last_seen: Mean,
    average: Mean,
}

/// Brier scores: the mean square of the predicted probability of "blocked now" minus the truth; lower is
/// better. `None` where all swept cells were always in view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrierScores {
    /// Of the two-state model, [`Mapper::blocked_probability`].
    pub model: Option<f64>,
    /// Of the state last seen; 0.5 for a cell never seen.
    pub last_seen: Option<f64>,
    /// Of the share of its time in view that the cell was blocked.
    pub average: Option<f64>,
}

impl Prediction {
    /// Compares the predictions for swept cells out of view with the ground truth now.
    pub fn sample(&mut self, mapper: &Mapper, truth: &impl GroundTruth) {
        for &index in truth.swept().iter().filter(|&&index| !mapper.is_in_view(index)) {
            let is_blocked = match truth.state(index) {
                TrueState::PartlyCovered => continue,
                state => f64::from(u8::from(state == TrueState::Blocked)),
            };
            let last_seen = match mapper.states().cells()[index] {
                CellState::Unknown => 0.5,
                CellState::Free => 0.0,
                CellState::Blocked => 1.0,
            };
            let seen = mapper.statistics(index);
            let watched = seen.watched_free + seen.watched_blocked;
            let average = if watched > 0.0 { seen.watched_blocked / watched } else { last_seen };
            let square = |prediction: f64| (prediction - is_blocked) * (prediction - is_blocked);
            self.model.add(square(mapper.blocked_probability(index)));
            self.last_seen.add(square(last_seen));
            self.average.add(square(average));
        }
    }

    /// The scores over all samples.
    pub fn scores(&self) -> BrierScores {
        BrierScores { model: self.model.get(), last_seen: self.last_seen.get(), average: self.average.get() }
    }
}

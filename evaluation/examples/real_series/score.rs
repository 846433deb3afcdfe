//! Scores of predictions.

use crate::models::Named;
use crate::series::{Looks, STEP_S, Series};
use mapper::Look;

/// The times ahead of a prediction, and the steps of the series.
pub(crate) const HORIZONS: [(&str, usize); 6] =
    [("1 min", 1), ("10 min", 10), ("30 min", 30), ("60 min", 60), ("24 h", 1440), ("7 d", 10080)];

/// Every model predicts at least this and at most one minus this, so that a log score is finite.
const MIN_PROBABILITY: f64 = 0.001;

/// Predictions are made every five minutes.
const PREDICT_EVERY: usize = 5;

/// The number of bins of predictions for the calibration.
const BINS: usize = 10;

/// The scores of one model at one horizon.
#[derive(Clone, Copy, Default)]
pub(crate) struct Score {
    brier: f64,
    log: f64,
    pub(crate) n: usize,
    /// For each bin of predictions: their number, their sum, and the number of those that came true.
    bins: [[f64; 3]; BINS],
}

impl Score {
    fn add(&mut self, predicted: f64, is_blocked: bool) {
        let predicted = predicted.clamp(MIN_PROBABILITY, 1.0 - MIN_PROBABILITY);
        let found = f64::from(u8::from(is_blocked));
        self.brier += (predicted - found) * (predicted - found);
        self.log -= if is_blocked { predicted.ln() } else { (1.0 - predicted).ln() };
        self.n += 1;
        let bin = &mut self.bins[((predicted * BINS as f64) as usize).min(BINS - 1)];
        *bin = [bin[0] + 1.0, bin[1] + predicted, bin[2] + found];
    }

    /// Adds the scores of other predictions.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.brier += other.brier;
        self.log += other.log;
        self.n += other.n;
        for (bin, other) in self.bins.iter_mut().zip(other.bins) {
            *bin = [bin[0] + other[0], bin[1] + other[1], bin[2] + other[2]];
        }
    }

    /// The mean squared error of the probability.
    pub(crate) fn brier(&self) -> f64 {
        self.brier / self.n as f64
    }

    /// The expected calibration error: the mean difference between predictions and how often they came true, over bins.
    pub(crate) fn calibration_error(&self) -> f64 {
        let apart: f64 = self.bins.iter().map(|[_, predicted, found]| (predicted - found).abs()).sum();
        apart / self.n as f64
    }

    /// The mean of −ln P of what happened.
    pub(crate) fn log_score(&self) -> f64 {
        self.log / self.n as f64
    }
}

/// Learns from the looks of the last `history_s` before the split; then, for each step after it, takes the look of this step
/// (without learning), and predicts all horizons.
pub(crate) fn score(
    series: &Series,
    looks: Looks,
    seed: u64,
    history_s: f64,
    model: &mut Named,
) -> [Score; HORIZONS.len()] {
    let is_seen = looks.draw(series.states.len(), seed);
    let split = series.split();
    let first = split.saturating_sub((history_s / STEP_S) as usize);
    let seen = |step: usize| series.look(step).filter(|_| is_seen[step]);
    let history: Vec<Look> = (first..split).filter_map(seen).collect();
    model.model.learn(&history);
    let mut scores = [Score::default(); HORIZONS.len()];
    for step in split..series.states.len() {
        if let Some(look) = seen(step) {
            model.model.look(look);
        }
        for (score, (_, ahead)) in scores.iter_mut().zip(HORIZONS).filter(|_| step % PREDICT_EVERY == 0) {
            if let Some(found) = series.look(step + ahead) {
                score.add(model.model.predict(found.time_s), found.is_blocked);
            }
        }
    }
    scores
}

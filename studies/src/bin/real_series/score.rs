//! Scores of predictions.

use crate::models::Named;
use crate::series::{Looks, STEP_S, Series};
use evaluation::metrics::ProbabilityScores;
use mapper::Look;

/// The times ahead of a prediction, and the steps of the series.
pub(crate) const HORIZONS: [(&str, usize); 6] =
    [("1 min", 1), ("10 min", 10), ("30 min", 30), ("60 min", 60), ("24 h", 1440), ("7 d", 10080)];

/// Every model predicts at least this and at most one minus this, as in the log score.
const MIN_PROBABILITY: f64 = 0.001;

/// Predictions are made every five minutes.
const PREDICT_EVERY: usize = 5;

/// Learns from the looks of the last `history_s` before the split; then, for each step after it, takes the look of this step
/// (without learning), and predicts all horizons.
pub(crate) fn score(
    series: &Series,
    looks: Looks,
    seed: u64,
    history_s: f64,
    model: &mut Named,
) -> [ProbabilityScores; HORIZONS.len()] {
    let is_seen = looks.draw(series.states.len(), seed);
    let split = series.split();
    let first = split.saturating_sub((history_s / STEP_S) as usize);
    let seen = |step: usize| series.look(step).filter(|_| is_seen[step]);
    let history: Vec<Look> = (first..split).filter_map(seen).collect();
    model.model.learn(&history);
    let mut scores = [ProbabilityScores::default(); HORIZONS.len()];
    for step in split..series.states.len() {
        if let Some(look) = seen(step) {
            model.model.look(look);
        }
        for (score, (_, ahead)) in scores.iter_mut().zip(HORIZONS).filter(|_| step % PREDICT_EVERY == 0) {
            if let Some(found) = series.look(step + ahead) {
                let predicted = model.model.predict(found.time_s);
                score.add(predicted.clamp(MIN_PROBABILITY, 1.0 - MIN_PROBABILITY), found.is_blocked);
            }
        }
    }
    scores
}

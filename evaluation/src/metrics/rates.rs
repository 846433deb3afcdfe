use super::auc::rate_auc;
use super::log_error::mean_log_error;
use super::mean::Mean;
use interfaces::GroundTruth;
use mapper::Mapper;
use serde::Serialize;

/// A cell counts for [`RateScores::rate_error`] when it was in view for this many true cycles.
const MIN_CYCLES: f64 = 3.0;

/// The estimated rates of change compared with the true rates so far.
#[derive(Clone, Debug, Default, Serialize)]
pub struct RateScores {
    /// Mean of |estimate − truth| / truth over the cells that truly changed and were in view for at least
    /// three true cycles; `None` without such cells.
    pub rate_error: Option<f64>,
    /// The number of these cells.
    pub rate_error_cells: usize,
    /// The same mean over all cells that truly changed; no estimate counts as 0.
    pub rate_error_all: Option<f64>,
    /// The log error of the rates, see [`super::mean_log_error`].
    pub log_error: Option<f64>,
    /// How well the rates separate changing cells from static ones: the area under the ROC curve. Cells
    /// within one cell of the border of the swept area are left out.
    pub rate_auc: Option<f64>,
    /// The number of observed cells that no moving thing ever touched.
    pub static_cells: usize,
    /// The number of change events on these cells.
    pub false_change_events: u64,
    /// The mean estimated cycle rate over these cells, per unit of time (Hz in a physics world).
    pub false_rate_hz: f64,
}

/// The two errors of the rates that a recording shows; NaN before anything changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateErrors {
    /// See [`RateScores::rate_error_all`].
    pub relative: f64,
    /// See [`RateScores::log_error`].
    pub log: f64,
}

impl From<&RateScores> for RateErrors {
    fn from(scores: &RateScores) -> Self {
        let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
        Self { relative: or_nan(scores.rate_error_all), log: or_nan(scores.log_error) }
    }
}

/// Compares the rates of `mapper` with the true rates so far.
pub fn rate_scores(mapper: &Mapper, truth: &impl GroundTruth) -> RateScores {
    let (mut in_view, mut all, mut false_rate) = (Mean::default(), Mean::default(), Mean::default());
    let mut false_change_events = 0;
    for index in 0..truth.frame().len() {
        let true_rate = truth.cycle_rate(index);
        if truth.is_swept(index) && true_rate > 0.0 {
            let error = (mapper.rate(index) - true_rate).abs() / true_rate;
            all.add(error);
            if mapper.statistics(index).observed() * true_rate >= MIN_CYCLES {
                in_view.add(error);
            }
        } else if !truth.is_swept(index) && mapper.was_ever_seen(index) {
            false_rate.add(mapper.rate(index));
            false_change_events += u64::from(mapper.statistics(index).events());
        }
    }
    RateScores {
        rate_error: in_view.get(),
        rate_error_cells: in_view.count,
        rate_error_all: all.get(),
        log_error: mean_log_error(mapper, truth),
        rate_auc: rate_auc(mapper, truth),
        static_cells: false_rate.count,
        false_change_events,
        false_rate_hz: false_rate.get().unwrap_or(0.0),
    }
}

use super::{Sample, TrialWorld};
use crate::metrics::{
    ChangingAccuracy, DevianceScores, Forecasts, PassageScores, Prediction, RateScores, map_scores,
    passage_scores, rate_scores,
};
use interfaces::GroundTruth;
use mapper::Mapper;

/// The number of samples of a trial.
const SAMPLES: u64 = 80;
/// Times are sums of steps of a physics world, s.
const SLACK: f64 = 1e-6;

/// Measures a trial at every reading, and samples the metrics.
#[derive(Default)]
pub(super) struct Sampler {
    length: u64,
    /// The time of the next sample.
    due: u64,
    samples: Vec<Sample>,
    readings: usize,
    /// The number of checks whether a swept cell is in view, and of those that found one.
    views: usize,
    views_of_changes: usize,
    /// Since the last sample.
    accuracy: ChangingAccuracy,
    /// Since the last sample.
    prediction: Prediction,
    /// Since the last sample.
    prediction_of_all: Prediction,
    forecasts: Forecasts,
}

impl Sampler {
    /// A sampler for a trial of a length.
    pub(super) fn new(length: u64) -> Self {
        Self { length, due: sample_time(0, length), ..Self::default() }
    }

    /// Measures one reading, and takes a sample if one is due.
    pub(super) fn update<W: TrialWorld>(&mut self, mapper: &Mapper, truth: &W::Truth) {
        let is_due = has_come(mapper.time(), self.due);
        self.forecasts.observe(mapper, truth, None);
        if is_due || self.readings.is_multiple_of(W::COMPARE_EVERY) {
            self.accuracy.sample(mapper, truth);
            self.prediction.sample(mapper, truth, None, |index| !mapper.is_in_view(index));
            self.prediction_of_all.sample(mapper, truth, None, |_| true);
        }
        if self.readings.is_multiple_of(W::VIEW_EVERY) {
            self.views += 1;
            self.views_of_changes += usize::from(truth.swept().iter().any(|&index| mapper.is_in_view(index)));
        }
        self.readings += 1;
        if is_due {
            let sample = self.sample(mapper, truth);
            self.samples.push(sample);
            self.due = sample_time(self.samples.len() as u64, self.length);
        }
    }

    /// Whether the trial is complete at a time.
    pub(super) fn is_complete(&self, time: f64) -> bool {
        has_come(time, self.length)
    }

    /// The samples.
    pub(super) fn into_samples(self) -> Vec<Sample> {
        self.samples
    }

    fn sample(&mut self, mapper: &Mapper, truth: &impl GroundTruth) -> Sample {
        let (rates, map) = (rate_scores(mapper, truth), map_scores(mapper, truth));
        let RateScores { rate_error_all, log_error, log_error_of_range, rate_auc, false_rate_hz, .. } = rates;
        let PassageScores { log_error_busy, busiest_tenth_hit } = passage_scores(mapper, truth);
        let DevianceScores { predictive_deviance, predictive_deviance_known, .. } =
            self.forecasts.scores().rates;
        let brier = std::mem::take(&mut self.prediction).scores();
        let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
        Sample {
            time: self.due,
            rate_error: or_nan(rate_error_all),
            log_error: or_nan(log_error),
            log_error_of_range: or_nan(log_error_of_range),
            map_quality: map.map_quality,
            map_quality_changing: or_nan(std::mem::take(&mut self.accuracy).scores().all),
            coverage: map.coverage,
            false_rate: false_rate_hz,
            changing_share: self.views_of_changes as f64 / self.views as f64,
            brier: or_nan(brier.brier),
            brier_of_all: or_nan(std::mem::take(&mut self.prediction_of_all).scores().brier),
            brier_last_seen: or_nan(brier.brier_last_seen),
            brier_mean: or_nan(brier.brier_mean),
            rate_auc: or_nan(rate_auc),
            predictive_deviance: or_nan(predictive_deviance),
            predictive_deviance_known: or_nan(predictive_deviance_known),
            passages_log_error: or_nan(log_error_busy),
            busiest_tenth_hit: or_nan(busiest_tenth_hit),
        }
    }
}

fn has_come(time: f64, due: u64) -> bool {
    time >= due as f64 - SLACK
}

/// The time of the sample of a number: denser early, the last one at the end.
fn sample_time(number: u64, length: u64) -> u64 {
    let part = (number + 1) as f64 / SAMPLES as f64;
    // Every time later than the one before, also in a short trial.
    let time = (length as f64 * part * part.sqrt()).round() as u64;
    if number >= SAMPLES { u64::MAX } else { time.max(number + 1).min(length) }
}

//! The measures that are compared: a metric of the samples, at the end of a trial or over the whole trial.

use super::trial::Sample;

/// A metric of the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Metric {
    /// [`Sample::rate_error`].
    RateError,
    /// [`Sample::log_error`].
    LogError,
    /// [`Sample::map_quality`].
    MapQuality,
    /// [`Sample::map_quality_changing`].
    MapQualityChanging,
    /// [`Sample::coverage`].
    Coverage,
    /// [`Sample::false_rate`].
    FalseRate,
    /// [`Sample::changing_share`].
    ChangingShare,
    /// [`Sample::brier`].
    Brier,
    /// [`Sample::brier_last_seen`].
    BrierLastSeen,
    /// [`Sample::brier_mean`].
    BrierMean,
}

impl Metric {
    /// All, in the order of the files.
    pub const ALL: [Self; 10] = [
        Self::RateError,
        Self::LogError,
        Self::MapQuality,
        Self::MapQualityChanging,
        Self::Coverage,
        Self::FalseRate,
        Self::ChangingShare,
        Self::Brier,
        Self::BrierLastSeen,
        Self::BrierMean,
    ];

    /// The name in `report.json` and `trials.csv`.
    pub fn name(self) -> &'static str {
        match self {
            Self::RateError => "rate_error",
            Self::LogError => "log_error",
            Self::MapQuality => "map_quality",
            Self::MapQualityChanging => "map_quality_changing",
            Self::Coverage => "coverage",
            Self::FalseRate => "false_rate",
            Self::ChangingShare => "changing_share",
            Self::Brier => "brier",
            Self::BrierLastSeen => "brier_last_seen",
            Self::BrierMean => "brier_mean",
        }
    }

    /// The value in `sample`.
    pub fn of(self, sample: &Sample) -> f64 {
        match self {
            Self::RateError => sample.rate_error,
            Self::LogError => sample.log_error,
            Self::MapQuality => sample.map_quality,
            Self::MapQualityChanging => sample.map_quality_changing,
            Self::Coverage => sample.coverage,
            Self::FalseRate => sample.false_rate,
            Self::ChangingShare => sample.changing_share,
            Self::Brier => sample.brier,
            Self::BrierLastSeen => sample.brier_last_seen,
            Self::BrierMean => sample.brier_mean,
        }
    }
}

/// The part of a curve that a measure takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// The value of the last sample.
    Final,
    /// The area under the curve divided by the length of the run: the mean over the run, in the
    /// unit of the metric.
    Area,
}

/// One number per trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Measure {
    /// The metric.
    pub metric: Metric,
    /// The part of its curve.
    pub part: Part,
}

impl Measure {
    /// Error of the logarithm of the rates over the run: the primary measure.
    pub const LOG_ERROR_AREA: Self = Self { metric: Metric::LogError, part: Part::Area };
    /// Error of the logarithm of the rates at the end.
    pub const FINAL_LOG_ERROR: Self = Self { metric: Metric::LogError, part: Part::Final };
    /// Relative error of the rates over the run.
    pub const RATE_ERROR_AREA: Self = Self { metric: Metric::RateError, part: Part::Area };
    /// Relative error of the rates at the end.
    pub const FINAL_RATE_ERROR: Self = Self { metric: Metric::RateError, part: Part::Final };
    /// Map quality at the end.
    pub const FINAL_MAP_QUALITY: Self = Self { metric: Metric::MapQuality, part: Part::Final };
    /// Map quality of the changing cells at the end.
    pub const FINAL_MAP_QUALITY_CHANGING: Self =
        Self { metric: Metric::MapQualityChanging, part: Part::Final };
    /// Brier score at the end.
    pub const FINAL_BRIER: Self = Self { metric: Metric::Brier, part: Part::Final };

    /// The measures in which strategies are compared pair by pair.
    pub const COMPARED: [Self; 7] = [
        Self::LOG_ERROR_AREA,
        Self::FINAL_LOG_ERROR,
        Self::RATE_ERROR_AREA,
        Self::FINAL_RATE_ERROR,
        Self::FINAL_MAP_QUALITY,
        Self::FINAL_MAP_QUALITY_CHANGING,
        Self::FINAL_BRIER,
    ];

    /// The name in `report.json`, as `final_log_error` or `log_error_area`.
    pub fn name(self) -> String {
        match self.part {
            Part::Final => format!("final_{}", self.metric.name()),
            Part::Area => format!("{}_area", self.metric.name()),
        }
    }
}

/// The area under the curve through `values` at `steps` (increasing), divided by its length.
///
/// Before the first step the first value holds, so that a curve which begins at step 1 is a mean
/// over the whole run. Where values are not a number the curve has gaps, and the mean is over the
/// rest; it is not a number where nothing is left.
pub(super) fn area(steps: &[u64], values: &[f64]) -> f64 {
    let (Some(&first_step), Some(&first)) = (steps.first(), values.first()) else { return f64::NAN };
    let (mut area, mut length) = (0.0, 0.0);
    if !first.is_nan() {
        area = first * first_step as f64;
        length = first_step as f64;
    }
    for (steps, values) in steps.windows(2).zip(values.windows(2)) {
        let height = (values[0] + values[1]) / 2.0;
        if !height.is_nan() {
            let width = (steps[1] - steps[0]) as f64;
            area += height * width;
            length += width;
        }
    }
    if length > 0.0 {
        area / length
    } else {
        values.iter().copied().find(|value| !value.is_nan()).unwrap_or(f64::NAN)
    }
}

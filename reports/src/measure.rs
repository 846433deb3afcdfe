//! The measures in which strategies are compared.

use evaluation::trials::Metric;
use serde::Serialize;

/// One number per trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(into = "String")]
pub enum Measure {
    /// The value of a metric in the last sample.
    Final(Metric),
    /// The area under the curve of a metric divided by the length of the run, that is, the mean over the run, in
    /// the unit of the metric.
    Area(Metric),
}

impl Measure {
    /// The primary measure: the log error of the rates over the run.
    pub const PRIMARY: Self = Self::Area(Metric::LogError);

    /// The measures in which strategies are compared pair by pair.
    pub const COMPARED: [Self; 7] = [
        Self::PRIMARY,
        Self::Final(Metric::LogError),
        Self::Area(Metric::RateError),
        Self::Final(Metric::RateError),
        Self::Final(Metric::MapQuality),
        Self::Final(Metric::MapQualityChanging),
        Self::Final(Metric::Brier),
    ];

    /// The name in `report.json`, as `final_log_error` or `log_error_area`.
    pub fn name(self) -> String {
        match self {
            Self::Final(metric) => format!("final_{}", metric.name()),
            Self::Area(metric) => format!("{}_area", metric.name()),
        }
    }
}

impl From<Measure> for String {
    fn from(measure: Measure) -> Self {
        measure.name()
    }
}

/// The area under the curve through `values` at `times` (increasing), divided by its length.
///
/// Before the first time, the first value is used, so that a curve that begins at step 1 gives a mean over the
/// whole run. Segments with NaN are left out of area and length. The result is NaN if there is no value.
pub(super) fn area(times: &[u64], values: &[f64]) -> f64 {
    let (Some(&first_time), Some(&first)) = (times.first(), values.first()) else { return f64::NAN };
    let (mut area, mut length) = (0.0, 0.0);
    if !first.is_nan() {
        area = first * first_time as f64;
        length = first_time as f64;
    }
    for (times, values) in times.windows(2).zip(values.windows(2)) {
        let height = (values[0] + values[1]) / 2.0;
        if !height.is_nan() {
            let width = (times[1] - times[0]) as f64;
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

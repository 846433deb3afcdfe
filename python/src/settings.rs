//! The settings of the task and of maps, from the keywords of a call.

use crate::convert::value_error;
use environments::DriveSettings;
use mapper::MapperSettings;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Deserialize;
use serde_json::{Map, Value};

/// The settings of the driving task, from keywords that are called as their fields.
pub(crate) fn task_settings(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<DriveSettings> {
    let Some(keywords) = keywords else { return Ok(DriveSettings::default()) };
    let py = keywords.py();
    let options = PyDict::new(py);
    // Scalars of NumPy are no numbers for `json`.
    options.set_item("default", py.import("operator")?.call_method1("methodcaller", ("item",))?)?;
    let text: String = py.import("json")?.call_method("dumps", (keywords,), Some(&options))?.extract()?;
    let settings: Map<String, Value> = serde_json::from_str(&text)
        .map_err(|_| value_error(format!("a setting is no finite number: {text}")))?;
    // One by one, so that the error names the setting.
    for (key, value) in &settings {
        let alone = Map::from_iter([(key.clone(), value.clone())]);
        DriveSettings::deserialize(Value::Object(alone))
            .map_err(|why| value_error(format!("the setting `{key}` cannot be {value}: {why}")))?;
    }
    DriveSettings::deserialize(Value::Object(settings)).map_err(value_error)
}

/// The settings with another estimator, occupancy model, gap and range noise.
pub(crate) fn mapper_settings(
    mut settings: MapperSettings,
    estimator: Option<&str>,
    occupancy: Option<&str>,
    max_gap: Option<f64>,
    range_noise: Option<f64>,
) -> PyResult<MapperSettings> {
    if let Some(name) = estimator {
        settings.estimator = name.parse().map_err(value_error)?;
    }
    if let Some(name) = occupancy {
        settings.occupancy = name.parse().map_err(value_error)?;
    }
    settings.max_gap = max_gap.unwrap_or(settings.max_gap);
    settings.steady.range_noise_std_m = range_noise.unwrap_or(settings.steady.range_noise_std_m);
    Ok(settings)
}

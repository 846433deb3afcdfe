//! The settings of tasks and of maps, from the keywords of a call.

use crate::convert::value_error;
use environments::{DriveSettings, ExploreSettings};
use mapper::MapperSettings;
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A setting of a task: its keyword, and what sets it.
type Setting<S> = (&'static str, fn(&mut S, &Bound<'_, PyAny>, &str) -> PyResult<()>);

const DRIVE: [Setting<DriveSettings>; 10] = [
    ("decision_s", |to, value, key| set(&mut to.decision_s, value, key)),
    ("max_steps", |to, value, key| set(&mut to.max_steps, value, key)),
    ("goal_radius", |to, value, key| set(&mut to.goal_radius_m, value, key)),
    ("min_goal", |to, value, key| set(&mut to.min_goal_m, value, key)),
    ("shows_path", |to, value, key| set(&mut to.shows_path, value, key)),
    ("shows_memory", |to, value, key| set(&mut to.shows_memory, value, key)),
    ("goal_reward", |to, value, key| set(&mut to.goal_reward, value, key)),
    ("progress_reward", |to, value, key| set(&mut to.progress_reward, value, key)),
    ("collision_reward", |to, value, key| set(&mut to.collision_reward, value, key)),
    ("step_reward", |to, value, key| set(&mut to.step_reward, value, key)),
];
const EXPLORE: [Setting<ExploreSettings>; 5] = [
    ("seen_reward", |to, value, key| set(&mut to.seen_reward, value, key)),
    ("max_steps", |to, value, key| set(&mut to.max_steps, value, key)),
    ("beams", |to, value, key| set(&mut to.beams, value, key)),
    ("update_reward", |to, value, key| set(&mut to.update_reward, value, key)),
    ("collision_reward", |to, value, key| set(&mut to.collision_reward, value, key)),
];

/// The settings of a driving task.
pub(crate) fn drive_settings(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<DriveSettings> {
    settings("driving", &DRIVE, keywords)
}

/// The settings of an exploring task.
pub(crate) fn explore_settings(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<ExploreSettings> {
    settings("exploring", &EXPLORE, keywords)
}

fn settings<S: Default>(
    task: &str,
    known: &[Setting<S>],
    keywords: Option<&Bound<'_, PyDict>>,
) -> PyResult<S> {
    let mut settings = S::default();
    for (key, value) in keywords.into_iter().flatten() {
        let key: String = key.extract()?;
        let Some((_, set)) = known.iter().find(|(known, _)| *known == key) else {
            let known: Vec<&str> = known.iter().map(|(known, _)| *known).collect();
            let known = known.join(", ");
            return Err(PyTypeError::new_err(format!(
                "the {task} task has no setting `{key}`; there are {known}"
            )));
        };
        set(&mut settings, &value, &key)?;
    }
    Ok(settings)
}

/// Sets a setting.
fn set<'a, 'py, T>(to: &mut T, value: &'a Bound<'py, PyAny>, key: &str) -> PyResult<()>
where
    T: FromPyObject<'a, 'py, Error: Into<PyErr>>,
{
    *to = T::extract(value.as_borrowed()).map_err(|error| {
        let error: PyErr = error.into();
        if error.is_instance_of::<PyOverflowError>(value.py()) {
            return PyValueError::new_err(format!("the setting `{key}` cannot be {value}: out of range"));
        }
        let (kind, message) = (error.get_type(value.py()), error.value(value.py()).to_string());
        PyErr::from_type(kind, format!("the setting `{key}` cannot be {value}: {message}"))
    })?;
    Ok(())
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

//! The settings of tasks, from the keywords of a call.

use environments::{DriveSettings, ExploreSettings};
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Settings from the keywords of a call: those of a driving task.
pub(crate) fn drive_settings(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<DriveSettings> {
    let mut settings = DriveSettings::default();
    for (key, value) in keywords.into_iter().flatten() {
        let key = key.extract::<String>()?;
        let key = key.as_str();
        match key {
            "decision_s" => settings.decision_s = of(&value, key)?,
            "max_steps" => settings.max_steps = of(&value, key)?,
            "goal_radius" => settings.goal_radius_m = of(&value, key)?,
            "min_goal" => settings.min_goal_m = of(&value, key)?,
            "shows_path" => settings.shows_path = of(&value, key)?,
            "goal_reward" => settings.goal_reward = of(&value, key)?,
            "progress_reward" => settings.progress_reward = of(&value, key)?,
            "collision_reward" => settings.collision_reward = of(&value, key)?,
            "step_reward" => settings.step_reward = of(&value, key)?,
            key => return Err(unknown("driving", key, DRIVE_KEYS)),
        }
    }
    Ok(settings)
}

const DRIVE_KEYS: &str = "decision_s, max_steps, goal_radius, min_goal, shows_path, goal_reward, progress_reward, \
                          collision_reward, step_reward";

/// Settings from the keywords of a call: those of an exploring task.
pub(crate) fn explore_settings(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<ExploreSettings> {
    let mut settings = ExploreSettings::default();
    for (key, value) in keywords.into_iter().flatten() {
        let key = key.extract::<String>()?;
        let key = key.as_str();
        match key {
            "max_steps" => settings.max_steps = of(&value, key)?,
            "beams" => settings.beams = of(&value, key)?,
            "error_every" => settings.error_every = of(&value, key)?,
            "map_every" => settings.map_every = of(&value, key)?,
            "update_reward" => settings.update_reward = of(&value, key)?,
            "error_reward" => settings.error_reward = of(&value, key)?,
            "collision_reward" => settings.collision_reward = of(&value, key)?,
            key => return Err(unknown("exploring", key, EXPLORE_KEYS)),
        }
    }
    Ok(settings)
}

const EXPLORE_KEYS: &str =
    "max_steps, beams, error_every, map_every, update_reward, error_reward, collision_reward";

/// The value of a setting.
fn of<'a, 'py, T>(value: &'a Bound<'py, PyAny>, key: &str) -> PyResult<T>
where
    T: FromPyObject<'a, 'py, Error: Into<PyErr>>,
{
    T::extract(value.as_borrowed()).map_err(|error| {
        let error: PyErr = error.into();
        if error.is_instance_of::<PyOverflowError>(value.py()) {
            return PyValueError::new_err(format!("the setting `{key}` cannot be {value}: out of range"));
        }
        let (kind, message) = (error.get_type(value.py()), error.value(value.py()).to_string());
        PyErr::from_type(kind, format!("the setting `{key}` cannot be {value}: {message}"))
    })
}

fn unknown(task: &str, key: &str, known: &str) -> PyErr {
    PyTypeError::new_err(format!("the {task} task has no setting `{key}`; there are {known}"))
}

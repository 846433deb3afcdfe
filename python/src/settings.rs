//! The settings of tasks, from the keywords of a call.

use environments::{DriveSettings, ExploreSettings};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Settings from the keywords of a call: those of a driving task.
pub(crate) fn drive_settings(keywords: Option<&Bound<'_, PyDict>>) -> PyResult<DriveSettings> {
    let mut settings = DriveSettings::default();
    for (key, value) in keywords.into_iter().flatten() {
        match key.extract::<String>()?.as_str() {
            "decision_s" => settings.decision_s = value.extract()?,
            "max_steps" => settings.max_steps = value.extract()?,
            "goal_radius" => settings.goal_radius_m = value.extract()?,
            "min_goal" => settings.min_goal_m = value.extract()?,
            "shows_path" => settings.shows_path = value.extract()?,
            "goal_reward" => settings.goal_reward = value.extract()?,
            "progress_reward" => settings.progress_reward = value.extract()?,
            "collision_reward" => settings.collision_reward = value.extract()?,
            "step_reward" => settings.step_reward = value.extract()?,
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
        match key.extract::<String>()?.as_str() {
            "max_steps" => settings.max_steps = value.extract()?,
            "beams" => settings.beams = value.extract()?,
            "error_every" => settings.error_every = value.extract()?,
            "map_every" => settings.map_every = value.extract()?,
            "update_reward" => settings.update_reward = value.extract()?,
            "error_reward" => settings.error_reward = value.extract()?,
            "collision_reward" => settings.collision_reward = value.extract()?,
            key => return Err(unknown("exploring", key, EXPLORE_KEYS)),
        }
    }
    Ok(settings)
}

const EXPLORE_KEYS: &str =
    "max_steps, beams, error_every, map_every, update_reward, error_reward, collision_reward";

fn unknown(task: &str, key: &str, known: &str) -> PyErr {
    PyTypeError::new_err(format!("the {task} task has no setting `{key}`; there are {known}"))
}

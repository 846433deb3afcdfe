use crate::{InflationSettings, MAX_PRICE};
use serde::{Deserialize, Serialize};

/// How the controller gets to goals, and when it gives up. Times are seconds, or steps in a grid
/// world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// How far paths keep from what is blocked.
    pub inflation: InflationSettings,
    /// When to plan again, to wait and to give up.
    pub patience: PatienceSettings,
    /// What to do at the goal.
    pub exploration: ExplorationSettings,
}

/// When to plan again, to wait and to give up.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct PatienceSettings {
    /// A path that a change has closed is planned anew, but not sooner after the last plan, s.
    pub replan_closed_s: f64,
    /// For all other reasons it is planned anew not sooner than this after the last plan, s.
    pub replan_s: f64,
    /// A robot farther from its path than this plans anew, m.
    pub off_path_m: f64,
    /// How long to wait where the robot is when the way to the goal closes, s. Longer than a slow
    /// robot takes to cross a door.
    pub wait_s: f64,
    /// A robot that has got nowhere for this long is stuck, s.
    pub patience_s: f64,
    /// A robot that stays within this distance gets nowhere, m.
    pub progress_m: f64,
    /// How often to try to get free within a metre before the goal is given up.
    pub max_recoveries: u32,
    /// A goal is given up after this time, whatever happens, s.
    pub goal_limit_s: f64,
}

impl Default for PatienceSettings {
    fn default() -> Self {
        Self {
            replan_closed_s: 0.2,
            replan_s: 0.5,
            off_path_m: 0.3,
            wait_s: 10.0,
            patience_s: 5.0,
            progress_m: 0.15,
            max_recoveries: 3,
            goal_limit_s: 180.0,
        }
    }
}

/// Local exploration at the goal (paper, section 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ExplorationSettings {
    /// At most this many steps, random ones included.
    pub max_steps: u32,
    /// At most this many random steps in a row. The paper's controller makes fewer than 2.
    pub max_random_steps: u32,
}

impl Default for ExplorationSettings {
    fn default() -> Self {
        Self { max_steps: 42, max_random_steps: 1 }
    }
}

/// A setting that makes no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} = {value}: must be {wanted}")]
pub struct SettingsError {
    /// The name of the setting.
    pub key: &'static str,
    /// What it is.
    pub value: f64,
    /// What would be right.
    pub wanted: &'static str,
}

impl Settings {
    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        let Self { inflation, patience, exploration: _ } = self;
        let positive = |key, value: f64| check(key, value, "a positive number", value > 0.0);
        check("margin_m", inflation.margin_m, "0 or more", inflation.margin_m >= 0.0)?;
        let wide = inflation.comfort_m >= inflation.margin_m;
        check("comfort_m", inflation.comfort_m, "at least margin_m", wide)?;
        let price = inflation.comfort_price;
        check("comfort_price", price.into(), "from 1 to 9", (1..=MAX_PRICE).contains(&price))?;
        check("replan_closed_s", patience.replan_closed_s, "0 or more", patience.replan_closed_s >= 0.0)?;
        check("replan_s", patience.replan_s, "0 or more", patience.replan_s >= 0.0)?;
        positive("off_path_m", patience.off_path_m)?;
        check("wait_s", patience.wait_s, "0 or more", patience.wait_s >= 0.0)?;
        positive("patience_s", patience.patience_s)?;
        positive("progress_m", patience.progress_m)?;
        let later = patience.goal_limit_s > patience.patience_s;
        check("goal_limit_s", patience.goal_limit_s, "more than patience_s", later)
    }
}

/// Refuses a value that is not finite or not `right`.
pub(crate) fn check(
    key: &'static str,
    value: f64,
    wanted: &'static str,
    right: bool,
) -> Result<(), SettingsError> {
    if right && value.is_finite() { Ok(()) } else { Err(SettingsError { key, value, wanted }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DiffDrive, DiffDriveSettings};

    #[test]
    fn what_is_wrong_is_named() {
        let message = |text: &str| toml::from_str::<Settings>(text).unwrap().check().unwrap_err().to_string();
        assert_eq!(message("inflation.comfort_m = 0.01"), "comfort_m = 0.01: must be at least margin_m");
        assert_eq!(message("inflation.margin_m = nan"), "margin_m = NaN: must be 0 or more");
        assert_eq!(message("inflation.comfort_price = 0"), "comfort_price = 0: must be from 1 to 9");
        assert_eq!(
            message("patience.goal_limit_s = inf\npatience.patience_s = 1"),
            "goal_limit_s = inf: must be more than patience_s"
        );
        let drive = |text: &str| DiffDrive::new(toml::from_str(text).unwrap()).unwrap_err().to_string();
        assert_eq!(drive("radius_m = -0.2"), "radius_m = -0.2: must be a positive number");
        assert_eq!(drive("tolerance_m = 0.4"), "tolerance_m = 0.4: must be less than twice radius_m");
    }

    #[test]
    fn defaults_are_right_and_unknown_keys_are_not() {
        assert_eq!(Settings::default().check(), Ok(()));
        assert!(DiffDrive::new(DiffDriveSettings::default()).is_ok());
        assert_eq!(toml::from_str::<Settings>("").unwrap(), Settings::default());
        assert!(toml::from_str::<Settings>("inflation.margin = 0.1").is_err());
        assert!(toml::from_str::<DiffDriveSettings>("speed = 1").is_err());
    }
}

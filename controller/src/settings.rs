use crate::{InflationSettings, MAX_PRICE};
use interfaces::SettingsError;
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

impl Settings {
    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        let Self { inflation, patience, exploration: _ } = self;
        let check = |key, value, expected, is_valid| check("controller", key, value, expected, is_valid);
        let positive = |key, value| check(key, value, "a positive number", value > 0.0);
        let not_negative = |key, value| check(key, value, "0 or more", value >= 0.0);
        not_negative("inflation.margin_m", inflation.margin_m)?;
        let is_wide = inflation.comfort_m >= inflation.margin_m;
        check("inflation.comfort_m", inflation.comfort_m, "at least inflation.margin_m", is_wide)?;
        let price = inflation.comfort_price;
        check("inflation.comfort_price", price.into(), "from 1 to 9", (1..=MAX_PRICE).contains(&price))?;
        not_negative("patience.replan_closed_s", patience.replan_closed_s)?;
        not_negative("patience.replan_s", patience.replan_s)?;
        positive("patience.off_path_m", patience.off_path_m)?;
        not_negative("patience.wait_s", patience.wait_s)?;
        positive("patience.patience_s", patience.patience_s)?;
        positive("patience.progress_m", patience.progress_m)?;
        let is_later = patience.goal_limit_s > patience.patience_s;
        check("patience.goal_limit_s", patience.goal_limit_s, "more than patience.patience_s", is_later)
    }
}

/// Refuses a value that is not finite, or not valid.
pub(crate) fn check(
    part: &'static str,
    key: &'static str,
    value: f64,
    expected: &'static str,
    is_valid: bool,
) -> Result<(), SettingsError> {
    if is_valid && value.is_finite() {
        return Ok(());
    }
    Err(SettingsError { part, key, expected, found: value.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DiffDrive, DiffDriveSettings};

    #[test]
    fn what_is_wrong_is_named() {
        let message = |text: &str| toml::from_str::<Settings>(text).unwrap().check().unwrap_err().to_string();
        assert_eq!(
            message("inflation.comfort_m = 0.01"),
            "controller setting `inflation.comfort_m` must be at least inflation.margin_m, not 0.01"
        );
        assert_eq!(
            message("inflation.margin_m = nan"),
            "controller setting `inflation.margin_m` must be 0 or more, not NaN"
        );
        assert_eq!(
            message("inflation.comfort_price = 0"),
            "controller setting `inflation.comfort_price` must be from 1 to 9, not 0"
        );
        assert_eq!(
            message("patience.goal_limit_s = inf\npatience.patience_s = 1"),
            "controller setting `patience.goal_limit_s` must be more than patience.patience_s, not inf"
        );
        let drive = |text: &str| DiffDrive::new(toml::from_str(text).unwrap()).unwrap_err().to_string();
        assert_eq!(
            drive("radius_m = -0.2"),
            "differential drive setting `radius_m` must be a positive number, not -0.2"
        );
        assert_eq!(
            drive("tolerance_m = 0.4"),
            "differential drive setting `tolerance_m` must be less than twice radius_m, not 0.4"
        );
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

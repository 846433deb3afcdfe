use crate::planner::{InflationSettings, MAX_COST};
use interfaces::{SettingsCheck, SettingsError};
use serde::{Deserialize, Serialize};

/// Settings of the controller. Times are seconds, or steps in a grid world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Settings of the distance between paths and obstacles.
    pub inflation: InflationSettings,
    /// Settings of navigation: when to replan, to wait and to give up.
    pub navigation: NavigationSettings,
    /// Settings of local exploration at the goal.
    pub exploration: ExplorationSettings,
}

/// Settings of navigation: when to replan, to wait and to give up.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct NavigationSettings {
    /// The minimum time between a plan and the next one if a change blocks the path, s.
    pub replan_blocked_s: f64,
    /// The minimum time between a plan and the next one for any other reason, s.
    pub replan_s: f64,
    /// The robot replans if it is farther from its path than this, m.
    pub off_path_m: f64,
    /// The time that the robot waits if the path to the goal is blocked, s. Longer than a slow robot needs to pass
    /// a door.
    pub wait_s: f64,
    /// The movement time allowance, s: the robot is stuck if it makes no progress for this time.
    pub movement_time_allowance_s: f64,
    /// The required movement radius, m: the robot makes no progress while it stays within this distance.
    pub required_movement_radius_m: f64,
    /// The maximum number of recoveries within a meter; after that the goal is given up.
    pub max_recoveries: u32,
    /// The maximum time for a goal, s; after that the goal is given up in any case.
    pub goal_timeout_s: f64,
}

impl Default for NavigationSettings {
    fn default() -> Self {
        Self {
            replan_blocked_s: 0.2,
            replan_s: 0.5,
            off_path_m: 0.3,
            wait_s: 10.0,
            movement_time_allowance_s: 5.0,
            required_movement_radius_m: 0.15,
            max_recoveries: 3,
            goal_timeout_s: 180.0,
        }
    }
}

/// Settings of local exploration at the goal (paper, section 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ExplorationSettings {
    /// The maximum number of steps, random ones included.
    pub max_steps: u32,
    /// The maximum number of consecutive random steps. In the paper fewer than 2.
    pub max_random_steps: u32,
}

impl Default for ExplorationSettings {
    fn default() -> Self {
        Self { max_steps: 42, max_random_steps: 1 }
    }
}

impl Settings {
    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        let Self { inflation, navigation, exploration: _ } = self;
        let check = SettingsCheck { part: "controller" };
        check.not_negative("inflation.footprint_padding_m", inflation.footprint_padding_m)?;
        let (is_wide, expected) =
            (inflation.inflation_m >= inflation.footprint_padding_m, "at least footprint_padding_m");
        check.valid("inflation.inflation_m", inflation.inflation_m, expected, is_wide)?;
        let costs = 1.0..=f64::from(MAX_COST);
        check.within("inflation.inflation_cost", inflation.inflation_cost, costs, "from 1 to 9")?;
        check.not_negative("navigation.replan_blocked_s", navigation.replan_blocked_s)?;
        check.not_negative("navigation.replan_s", navigation.replan_s)?;
        check.positive("navigation.off_path_m", navigation.off_path_m)?;
        check.not_negative("navigation.wait_s", navigation.wait_s)?;
        let allowance_s = navigation.movement_time_allowance_s;
        check.positive("navigation.movement_time_allowance_s", allowance_s)?;
        check.positive("navigation.required_movement_radius_m", navigation.required_movement_radius_m)?;
        let (timeout_s, expected) = (navigation.goal_timeout_s, "more than movement_time_allowance_s");
        check.valid("navigation.goal_timeout_s", timeout_s, expected, timeout_s > allowance_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DiffDrive, DiffDriveSettings};
    use serde::de::value::{Error, MapDeserializer};

    #[test]
    fn errors_name_the_setting() {
        let message = |change: fn(&mut Settings)| {
            let mut settings = Settings::default();
            change(&mut settings);
            settings.check().unwrap_err().to_string()
        };
        assert_eq!(
            message(|settings| settings.inflation.inflation_m = 0.01),
            "controller setting `inflation.inflation_m` must be at least footprint_padding_m, not 0.01"
        );
        assert_eq!(
            message(|settings| settings.inflation.footprint_padding_m = f64::NAN),
            "controller setting `inflation.footprint_padding_m` must be 0 or more, not NaN"
        );
        assert_eq!(
            message(|settings| settings.inflation.inflation_cost = 0),
            "controller setting `inflation.inflation_cost` must be from 1 to 9, not 0"
        );
        assert_eq!(
            message(|settings| {
                settings.navigation.goal_timeout_s = f64::INFINITY;
                settings.navigation.movement_time_allowance_s = 1.0;
            }),
            "controller setting `navigation.goal_timeout_s` must be more than movement_time_allowance_s, not inf"
        );
        let drive = |settings| DiffDrive::new(settings).unwrap_err().to_string();
        assert_eq!(
            drive(DiffDriveSettings { radius_m: -0.2, ..Default::default() }),
            "differential drive setting `radius_m` must be a positive number, not -0.2"
        );
        assert_eq!(
            drive(DiffDriveSettings { tolerance_m: 0.4, ..Default::default() }),
            "differential drive setting `tolerance_m` must be less than twice radius_m, not 0.4"
        );
    }

    #[test]
    fn defaults_are_valid_and_unknown_keys_are_refused() {
        assert_eq!(Settings::default().check(), Ok(()));
        assert!(DiffDrive::new(DiffDriveSettings::default()).is_ok());
        let keys = |key: &'static str| {
            MapDeserializer::<_, Error>::new((!key.is_empty()).then_some((key, 0.1)).into_iter())
        };
        assert_eq!(Settings::deserialize(keys("")).unwrap(), Settings::default());
        let unknown = "unknown field `margin`";
        let error = InflationSettings::deserialize(keys("margin")).unwrap_err().to_string();
        assert!(error.starts_with(unknown), "{error}");
        assert!(Settings::deserialize(keys("margin")).unwrap_err().to_string().starts_with(unknown));
        assert!(DiffDriveSettings::deserialize(keys("margin")).unwrap_err().to_string().starts_with(unknown));
    }
}

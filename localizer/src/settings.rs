use crate::constants::{LIMIT_NOISE_M, LOG_NOISE_M};
use interfaces::{SettingsCheck, SettingsError};

/// Settings of a [`Localizer`](crate::Localizer), and of a [`TrajectoryFinder`](crate::TrajectoryFinder), which uses the first one.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct LocalizerSettings {
    /// The standard deviation of the range noise of the laser, m.
    pub range_noise_std_m: f64,
    /// The time without a certain pose after which the robot is lost, s.
    pub lost_after_s: f64,
}

impl Default for LocalizerSettings {
    fn default() -> Self {
        Self { range_noise_std_m: LIMIT_NOISE_M, lost_after_s: 2.0 }
    }
}

impl LocalizerSettings {
    /// For the trajectories of logs, whose walls are less straight.
    pub fn of_logs() -> Self {
        Self { range_noise_std_m: LOG_NOISE_M, ..Self::default() }
    }

    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        let check = SettingsCheck { part: "localizer" };
        check.within("range_noise_std_m", self.range_noise_std_m, 0.0..=0.5, "from 0 to 0.5 m")?;
        check.not_negative("lost_after_s", self.lost_after_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_settings_are_named() {
        let refused = |settings: LocalizerSettings| settings.check().unwrap_err().key;
        let defaults = LocalizerSettings::default;
        assert_eq!(defaults().check(), Ok(()));
        assert_eq!(refused(LocalizerSettings { lost_after_s: f64::NAN, ..defaults() }), "lost_after_s");
        let noise = LocalizerSettings { range_noise_std_m: -0.1, ..defaults() };
        assert_eq!(refused(noise), "range_noise_std_m");
    }
}

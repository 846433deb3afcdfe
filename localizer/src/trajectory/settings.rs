use crate::scan_points::PointRules;
use crate::settings::{LocalizerSettings, OdometryTrust};
use interfaces::SettingsError;

/// Settings of a [`TrajectoryFinder`](crate::TrajectoryFinder).
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrajectorySettings {
    /// The standard deviation of the range noise of the laser, m.
    pub range_noise_std_m: f64,
    /// The largest errors of the odometry that are expected.
    pub odometry: OdometryTrust,
}

impl Default for TrajectorySettings {
    fn default() -> Self {
        Self { range_noise_std_m: 0.02, odometry: OdometryTrust::default() }
    }
}

impl TrajectorySettings {
    /// The points of the scans of logs: the scans are sparse and their walls less straight, so that grazing beams are no
    /// good evidence.
    pub(super) fn point_rules(&self) -> PointRules {
        PointRules { noise_m: self.range_noise_std_m, grazing: false }
    }

    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        // The odometry and the noise have the same limits as those of a localizer.
        let shared = LocalizerSettings {
            range_noise_std_m: self.range_noise_std_m,
            odometry: self.odometry,
            ..LocalizerSettings::default()
        };
        shared.check()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_settings_are_named() {
        let refused = |settings: TrajectorySettings| settings.check().unwrap_err().key;
        let defaults = TrajectorySettings::default;
        assert_eq!(defaults().check(), Ok(()));
        assert_eq!(
            refused(TrajectorySettings { range_noise_std_m: -1.0, ..defaults() }),
            "range_noise_std_m"
        );
    }
}

use crate::scan_points::PointRules;
use crate::settings::{LocalizerSettings, OdometryTrust};
use interfaces::{SettingsCheck, SettingsError};

/// Settings of a [`TrajectoryFinder`](crate::TrajectoryFinder).
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrajectorySettings {
    /// The standard deviation of the range noise of the laser, m.
    pub range_noise_std_m: f64,
    /// The largest errors of the odometry that are expected.
    pub odometry: OdometryTrust,
    /// A scan becomes a keyframe where the robot moved this far since the last one, m ...
    pub keyframe_m: f64,
    /// ... or turned by this much, rad.
    pub keyframe_rad: f64,
    /// The number of keyframes of a submap.
    pub submap_keyframes: usize,
    /// Whether loops are closed. Only comparisons set it to false.
    pub close_loops: bool,
}

impl Default for TrajectorySettings {
    fn default() -> Self {
        Self {
            range_noise_std_m: 0.02,
            odometry: OdometryTrust::default(),
            keyframe_m: 0.3,
            keyframe_rad: 0.2,
            submap_keyframes: 20,
            close_loops: true,
        }
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
        shared.check()?;
        let check = SettingsCheck { part: "trajectory" };
        check.positive("keyframe_m", self.keyframe_m)?;
        check.positive("keyframe_rad", self.keyframe_rad)?;
        check.within("submap_keyframes", self.submap_keyframes as f64, 4.0..=1000.0, "from 4 to 1000")
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
        assert_eq!(refused(TrajectorySettings { keyframe_m: 0.0, ..defaults() }), "keyframe_m");
        assert_eq!(refused(TrajectorySettings { submap_keyframes: 1, ..defaults() }), "submap_keyframes");
        assert_eq!(
            refused(TrajectorySettings { range_noise_std_m: -1.0, ..defaults() }),
            "range_noise_std_m"
        );
    }
}

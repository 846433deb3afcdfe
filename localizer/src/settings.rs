use crate::constants::{LIMIT_NOISE_M, LOG_NOISE_M};
use interfaces::{SettingsCheck, SettingsError};

/// Hard drift, the largest errors of an odometry that are expected by default: gains, and noise after 1 m and after 1 rad; and
/// rad per m, which is 3°.
const HARD_DRIFT: f64 = 0.05;
const HARD_DRIFT_RADPM: f64 = 0.052;

/// Settings of a [`Localizer`](crate::Localizer), and of a [`TrajectoryFinder`](crate::TrajectoryFinder), which uses the first two.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct LocalizerSettings {
    /// The standard deviation of the range noise of the laser, m.
    pub range_noise_std_m: f64,
    /// The largest errors of the odometry that are expected.
    pub odometry: OdometryTrust,
    /// The time without a certain pose after which the robot is lost, s.
    pub lost_after_s: f64,
    /// Learned rates of change lower the weight of a surface in a search by exp(−rate · horizon), s; 0 ignores the
    /// rates.
    pub rate_horizon_s: f64,
}

/// The largest errors of the odometry that are expected: systematic errors that can grow by this much per meter
/// traveled and per radian turned, and noise whose variance grows with the distance.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct OdometryTrust {
    /// The systematic error of the distance per meter traveled.
    pub distance_gain: f64,
    /// The systematic error of the heading per radian turned.
    pub turn_gain: f64,
    /// The systematic error of the heading per meter traveled, rad/m.
    pub turn_radpm: f64,
    /// The standard deviation of the distance after 1 m, m; it grows with the square root of the distance.
    pub distance_noise_m: f64,
    /// The standard deviation of the heading after a turn of 1 rad, rad; it grows with the square root of the turn.
    pub turn_noise_rad: f64,
}

impl Default for OdometryTrust {
    /// Hard drift: gains of 5 %, 3° per meter, and noise of the same size.
    fn default() -> Self {
        Self {
            distance_gain: HARD_DRIFT,
            turn_gain: HARD_DRIFT,
            turn_radpm: HARD_DRIFT_RADPM,
            distance_noise_m: HARD_DRIFT,
            turn_noise_rad: HARD_DRIFT,
        }
    }
}

impl Default for LocalizerSettings {
    fn default() -> Self {
        Self {
            range_noise_std_m: LIMIT_NOISE_M,
            odometry: OdometryTrust::default(),
            lost_after_s: 2.0,
            rate_horizon_s: 1000.0,
        }
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
        let odometry = &self.odometry;
        for (key, value) in [
            ("odometry.distance_gain", odometry.distance_gain),
            ("odometry.turn_gain", odometry.turn_gain),
            ("odometry.turn_radpm", odometry.turn_radpm),
            ("odometry.distance_noise_m", odometry.distance_noise_m),
            ("odometry.turn_noise_rad", odometry.turn_noise_rad),
        ] {
            check.within(key, value, 0.0..=10.0, "from 0 to 10")?;
        }
        check.not_negative("lost_after_s", self.lost_after_s)?;
        check.not_negative("rate_horizon_s", self.rate_horizon_s)
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
        let odometry = OdometryTrust { turn_gain: -0.1, ..OdometryTrust::default() };
        assert_eq!(refused(LocalizerSettings { odometry, ..defaults() }), "odometry.turn_gain");
    }
}

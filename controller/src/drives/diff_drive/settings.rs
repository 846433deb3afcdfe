use interfaces::{SettingsCheck, SettingsError};

/// Settings of a differential drive robot: its body and its limits.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct DiffDriveSettings {
    /// The radius of the footprint, m.
    pub radius_m: f64,
    /// The maximum linear speed, m/s.
    pub max_linear_mps: f64,
    /// The maximum angular speed, rad/s.
    pub max_angular_radps: f64,
    /// The linear acceleration and deceleration, m/s². The value must not be higher than the robot can reach;
    /// otherwise the robot touches obstacles before it stops.
    pub acceleration_mps2: f64,
    /// The angular acceleration, rad/s².
    pub angular_acceleration_radps2: f64,
    /// The robot has arrived at a point if it is nearer than this, m.
    pub tolerance_m: f64,
    /// The time from a reading until its command has an effect and the next command can have one, s: a little
    /// longer than a tick.
    pub reaction_s: f64,
}

impl Default for DiffDriveSettings {
    fn default() -> Self {
        Self {
            radius_m: 0.2,
            max_linear_mps: 0.5,
            max_angular_radps: 1.5,
            acceleration_mps2: 1.0,
            angular_acceleration_radps2: 4.0,
            tolerance_m: 0.1,
            reaction_s: 0.15,
        }
    }
}

impl DiffDriveSettings {
    pub(super) fn check(&self) -> Result<(), SettingsError> {
        let check = SettingsCheck { part: "differential drive" };
        check.positive("radius_m", self.radius_m)?;
        check.positive("max_linear_mps", self.max_linear_mps)?;
        check.positive("max_angular_radps", self.max_angular_radps)?;
        check.positive("acceleration_mps2", self.acceleration_mps2)?;
        check.positive("angular_acceleration_radps2", self.angular_acceleration_radps2)?;
        check.positive("tolerance_m", self.tolerance_m)?;
        check.not_negative("reaction_s", self.reaction_s)?;
        // A step of local exploration, a diameter long, must not end where it begins.
        let is_short = self.tolerance_m < 2.0 * self.radius_m;
        check.valid("tolerance_m", self.tolerance_m, "less than twice radius_m", is_short)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_setting() {
        let refused = |settings: DiffDriveSettings| settings.check().unwrap_err().to_string();
        assert_eq!(DiffDriveSettings::default().check(), Ok(()));
        assert_eq!(
            refused(DiffDriveSettings { radius_m: -0.2, ..Default::default() }),
            "differential drive setting `radius_m` must be a positive number, not -0.2"
        );
        assert_eq!(
            refused(DiffDriveSettings { tolerance_m: 0.4, ..Default::default() }),
            "differential drive setting `tolerance_m` must be less than twice radius_m, not 0.4"
        );
    }
}

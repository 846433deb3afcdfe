use crate::settings::check;
use interfaces::SettingsError;
use serde::{Deserialize, Serialize};

/// The body of a diff-drive robot and how it follows paths.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct DiffDriveSettings {
    /// The radius of its outline, m.
    pub radius_m: f64,
    /// It drives no faster than this, m/s.
    pub max_linear_mps: f64,
    /// It turns no faster than this, rad/s.
    pub max_angular_radps: f64,
    /// It speeds up and brakes with this, m/s². No more than the robot can do, or it will touch
    /// what it should have stopped for.
    pub acceleration_mps2: f64,
    /// It changes how fast it turns with this, rad/s².
    pub angular_acceleration_radps2: f64,
    /// It steers towards the point of the path this far ahead, m. More cuts corners, less wobbles.
    pub lookahead_m: f64,
    /// It turns in place first when the path leads away from where it looks by more, rad.
    pub turn_in_place_rad: f64,
    /// It has arrived at a point when it is this near, m.
    pub tolerance_m: f64,
    /// The time from a reading until its command acts and the next can, s: one tick and a bit.
    pub reaction_s: f64,
    /// The least distance to anything sensed, m; less than the margin of the inflation, or paths
    /// along walls cannot be followed.
    pub clearance_m: f64,
    /// For each m/s of speed this much clearance more, s.
    pub clearance_s: f64,
    /// What may move does so at most this fast, m/s.
    pub others_mps: f64,
    /// It backs away at this speed when it is stuck, m/s.
    pub reverse_mps: f64,
}

impl Default for DiffDriveSettings {
    fn default() -> Self {
        Self {
            radius_m: 0.2,
            max_linear_mps: 0.5,
            max_angular_radps: 1.5,
            acceleration_mps2: 1.0,
            angular_acceleration_radps2: 4.0,
            lookahead_m: 0.35,
            turn_in_place_rad: 0.9,
            tolerance_m: 0.1,
            reaction_s: 0.15,
            clearance_m: 0.015,
            clearance_s: 0.05,
            others_mps: 0.3,
            reverse_mps: 0.15,
        }
    }
}

impl DiffDriveSettings {
    pub(super) fn check(&self) -> Result<(), SettingsError> {
        let check =
            |key, value, expected, is_valid| check("differential drive", key, value, expected, is_valid);
        let positive = |key, value| check(key, value, "a positive number", value > 0.0);
        let at_least_zero = |key, value| check(key, value, "0 or more", value >= 0.0);
        positive("radius_m", self.radius_m)?;
        positive("max_linear_mps", self.max_linear_mps)?;
        positive("max_angular_radps", self.max_angular_radps)?;
        positive("acceleration_mps2", self.acceleration_mps2)?;
        positive("angular_acceleration_radps2", self.angular_acceleration_radps2)?;
        positive("lookahead_m", self.lookahead_m)?;
        positive("turn_in_place_rad", self.turn_in_place_rad)?;
        positive("tolerance_m", self.tolerance_m)?;
        at_least_zero("reaction_s", self.reaction_s)?;
        at_least_zero("clearance_m", self.clearance_m)?;
        at_least_zero("clearance_s", self.clearance_s)?;
        at_least_zero("others_mps", self.others_mps)?;
        positive("reverse_mps", self.reverse_mps)?;
        // A step of local exploration, a diameter long, must not have arrived where it begins.
        let is_short = self.tolerance_m < 2.0 * self.radius_m;
        check("tolerance_m", self.tolerance_m, "less than twice radius_m", is_short)
    }
}

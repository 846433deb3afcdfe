use interfaces::{SettingsCheck, SettingsError};
use serde::{Deserialize, Serialize};

/// The body of a differential drive robot, and how it follows paths.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct DiffDriveSettings {
    /// The radius of the footprint, m.
    pub radius_m: f64,
    /// The maximum speed, m/s.
    pub max_linear_mps: f64,
    /// The maximum rate of turn, rad/s.
    pub max_angular_radps: f64,
    /// The acceleration and deceleration, m/s². No more than the robot can do, or it touches what it should
    /// have stopped for.
    pub acceleration_mps2: f64,
    /// The acceleration of a turn, rad/s².
    pub angular_acceleration_radps2: f64,
    /// The distance of the pursued point ahead on the path, m. A larger one cuts corners, a smaller one
    /// makes the robot oscillate.
    pub lookahead_m: f64,
    /// The robot turns in place where the path leads away from its heading by more, rad.
    pub turn_in_place_rad: f64,
    /// The distance to a point at which the robot has arrived there, m.
    pub tolerance_m: f64,
    /// The time from a reading until its command acts and the next can, s: a little more than a tick.
    pub reaction_s: f64,
    /// The least distance to sensed obstacles, m; less than the footprint padding of the inflation, or
    /// paths along walls cannot be followed.
    pub clearance_m: f64,
    /// The additional clearance per m/s of speed, s.
    pub clearance_s: f64,
    /// The maximum speed of dynamic obstacles, m/s.
    pub max_obstacle_mps: f64,
    /// The speed of backing up in a recovery, m/s.
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
            max_obstacle_mps: 0.3,
            reverse_mps: 0.15,
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
        check.positive("lookahead_m", self.lookahead_m)?;
        check.positive("turn_in_place_rad", self.turn_in_place_rad)?;
        check.positive("tolerance_m", self.tolerance_m)?;
        check.not_negative("reaction_s", self.reaction_s)?;
        check.not_negative("clearance_m", self.clearance_m)?;
        check.not_negative("clearance_s", self.clearance_s)?;
        check.not_negative("max_obstacle_mps", self.max_obstacle_mps)?;
        check.positive("reverse_mps", self.reverse_mps)?;
        // A step of local exploration, a diameter long, must not end where it begins.
        let is_short = self.tolerance_m < 2.0 * self.radius_m;
        check.valid("tolerance_m", self.tolerance_m, "less than twice radius_m", is_short)
    }
}

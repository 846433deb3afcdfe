use interfaces::{SettingsCheck, SettingsError};
use serde::{Deserialize, Serialize};

/// Settings of a differential drive robot: its body, its limits, and how it follows paths.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
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
    /// The distance along the path to the pursued point, m. A larger value makes the robot cut corners, a smaller
    /// value makes it oscillate.
    pub lookahead_m: f64,
    /// The robot turns in place if the angle between its heading and the path is larger than this, rad.
    pub turn_in_place_rad: f64,
    /// The robot has arrived at a point if it is nearer than this, m.
    pub tolerance_m: f64,
    /// The time from a reading until its command has an effect and the next command can have one, s: a little
    /// longer than a tick.
    pub reaction_s: f64,
    /// The minimum distance to sensed obstacles, m. It must be less than the footprint padding of the inflation;
    /// otherwise the robot cannot follow paths along walls.
    pub clearance_m: f64,
    /// The additional clearance per m/s of speed, s.
    pub clearance_s: f64,
    /// The maximum speed of dynamic obstacles, m/s. With 0.3 m/s, doors and robots reached a robot that was still braking
    /// six times in five runs of 20 minutes; with 0.5 m/s once.
    pub max_obstacle_mps: f64,
    /// The backward speed in a recovery, m/s.
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
            max_obstacle_mps: 0.5,
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

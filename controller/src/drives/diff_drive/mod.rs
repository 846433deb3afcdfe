//! A robot with two driven wheels: turns in place, drives along arcs.

mod collision_monitor;

use super::{Body, Drive, DriveScene};
use crate::planner::{Costmap, InflationSettings, Moves, Path};
use collision_monitor::CollisionMonitor;
use interfaces::{SettingsCheck, SettingsError, Twist, Values, values};
use nalgebra::Point2;
use std::f64::consts::{PI, TAU};

/// Half a cell of rounding and the error of path following; and what leads paths through the middle of doors, and not along walls.
const INFLATION: InflationSettings =
    InflationSettings { footprint_padding_m: 0.08, inflation_m: 0.25, inflation_cost: 3 };
/// The distance along the path to the pursued point, m. With a larger value the robot cuts corners, with a smaller one it
/// oscillates.
const LOOKAHEAD_M: f64 = 0.35;
/// The robot turns in place if the angle between its heading and the path is larger than this, rad.
const TURN_IN_PLACE_RAD: f64 = 0.9;
/// The backward speed in a recovery, m/s.
const REVERSE_MPS: f64 = 0.15;
/// A turn in place ends at this share of [`TURN_IN_PLACE_RAD`], so that it does not begin again at once.
const TURNED: f64 = 0.3;
/// The minimum speed at the end of a path, m/s.
const CREEP_MPS: f64 = 0.05;
/// The duration of a recovery, s.
const RECOVERY_S: f64 = 2.0;
/// The maximum duration of a tick, s, that is used to limit the change of speed.
const LONGEST_TICK_S: f64 = 0.2;
/// The angular speed of a robot that looks around, rad/s.
const LOOK_AROUND_RADPS: f64 = 0.5;
/// The speed of a robot that has looked around and goes on to look from elsewhere, m/s.
const LOOK_ELSEWHERE_MPS: f64 = 0.2;

/// Follows paths by pure pursuit (Coulter 1992) of the farthest visible point ahead, turns in place if the path is
/// behind the robot, and brakes for sensed obstacles.
#[derive(Clone, Debug)]
pub struct DiffDrive {
    settings: DiffDriveSettings,
    monitor: CollisionMonitor,
    is_turning: bool,
    /// How far the robot has turned since it began to look around, rad.
    looked_rad: f64,
    last: Twist,
    last_time_s: f64,
}

impl DiffDrive {
    /// A drive of a robot at rest.
    ///
    /// # Errors
    ///
    /// When a setting is out of range; the error names it.
    pub fn new(settings: DiffDriveSettings) -> Result<Self, SettingsError> {
        settings.check()?;
        let monitor = CollisionMonitor::default();
        Ok(Self {
            settings,
            monitor,
            is_turning: false,
            looked_rad: 0.0,
            last: Twist::STOP,
            last_time_s: f64::NEG_INFINITY,
        })
    }

    /// The rate of a turn in place by `angle_rad` from which the robot can still stop at that angle.
    fn turn_radps(&self, angle_rad: f64) -> f64 {
        // Half of the deceleration that is possible: the robot senses its heading only once per tick.
        let brakeable = (self.settings.angular_acceleration_radps2 * angle_rad.abs()).sqrt();
        brakeable.min(self.settings.max_angular_radps).copysign(angle_rad)
    }

    /// Limits the acceleration within a tick. The robot itself limits the deceleration.
    fn command(&mut self, scene: &DriveScene, wish: Twist) -> Twist {
        let tick_s = (scene.input.time - self.last_time_s).clamp(0.0, LONGEST_TICK_S);
        let faster = self.settings.acceleration_mps2 * tick_s;
        let turns_more = self.settings.angular_acceleration_radps2 * tick_s;
        let (v, w) = (self.last.linear_mps, self.last.angular_radps);
        self.last = Twist {
            linear_mps: wish.linear_mps.clamp(v.min(0.0) - faster, v.max(0.0) + faster),
            angular_radps: wish.angular_radps.clamp(w.min(0.0) - turns_more, w.max(0.0) + turns_more),
        };
        self.last_time_s = scene.input.time;
        self.last
    }
}

impl Drive for DiffDrive {
    type Command = Twist;

    fn values(&mut self) -> Values<'_> {
        values![self.is_turning, self.looked_rad, self.last, self.last_time_s]
    }

    fn body(&self) -> Body {
        let DiffDriveSettings { radius_m, tolerance_m, max_linear_mps, .. } = self.settings;
        let step_m = 2.0 * radius_m;
        let step_s = step_m / max_linear_mps;
        Body {
            radius_m,
            inflation: INFLATION,
            moves: Moves::Eight,
            speed_mps: max_linear_mps,
            tolerance_m,
            step_m,
            directions: 16,
            step_s,
            // The time to turn around, to accelerate and to brake.
            step_limit_s: 2.0 * step_s + PI / self.settings.max_angular_radps,
            goal_timeout_s: 180.0,
        }
    }

    fn follow(&mut self, scene: &DriveScene, path: &Path) -> Twist {
        let settings = self.settings;
        self.looked_rad = 0.0;
        let position = scene.input.position();
        let Some(target) = visible_lookahead_point(scene.costmap, path, &position, LOOKAHEAD_M) else {
            return self.rest(scene);
        };
        let towards = scene.input.pose.inverse_transform_point(&target).coords;
        let off_rad = libm::atan2(towards.y, towards.x);
        let allowed_rad = TURN_IN_PLACE_RAD * if self.is_turning { TURNED } else { 1.0 };
        self.is_turning = off_rad.abs() > allowed_rad;
        let turn = Twist { linear_mps: 0.0, angular_radps: self.turn_radps(off_rad) };
        if self.is_turning {
            return self.command(scene, turn);
        }
        // The arc that starts in the direction of the robot's heading and passes through the target.
        let curvature_radpm = 2.0 * towards.y / towards.norm_squared().max(1e-6);
        let end_mps = (settings.acceleration_mps2 * path.remaining_m(&position)).sqrt().max(CREEP_MPS);
        let aligned = 1.0 - (off_rad / TURN_IN_PLACE_RAD).abs();
        let wish_mps = (settings.max_linear_mps * aligned.max(0.2))
            .min(end_mps)
            .min(settings.max_angular_radps / curvature_radpm.abs().max(1e-6))
            .min(self.last.linear_mps.max(0.0) + settings.acceleration_mps2 * LONGEST_TICK_S);
        self.monitor.update(&settings, scene, wish_mps);
        let safe_mps = self.monitor.safe_speed_mps(&settings, wish_mps, curvature_radpm);
        if safe_mps == 0.0 {
            return self.command(scene, turn);
        }
        self.command(scene, Twist { linear_mps: safe_mps, angular_radps: safe_mps * curvature_radpm })
    }

    fn rest(&mut self, scene: &DriveScene) -> Twist {
        (self.is_turning, self.looked_rad) = (false, 0.0);
        self.command(scene, Twist::STOP)
    }

    /// Turns once around. What is seen from here does not tell the pose then: the robot drives ahead where that is safe,
    /// and turns where it is not.
    fn look_around(&mut self, scene: &DriveScene) -> Twist {
        self.is_turning = false;
        let settings = self.settings;
        let turn_radps = LOOK_AROUND_RADPS.min(settings.max_angular_radps);
        let turn = Twist { linear_mps: 0.0, angular_radps: turn_radps };
        if self.looked_rad < TAU {
            let tick_s = (scene.input.time - self.last_time_s).clamp(0.0, LONGEST_TICK_S);
            self.looked_rad += turn_radps * tick_s;
            return self.command(scene, turn);
        }
        let wish_mps = LOOK_ELSEWHERE_MPS.min(settings.max_linear_mps);
        self.monitor.update(&settings, scene, wish_mps);
        match self.monitor.safe_speed_mps(&settings, wish_mps, 0.0) {
            0.0 => self.command(scene, turn),
            linear_mps => self.command(scene, Twist { linear_mps, angular_radps: 0.0 }),
        }
    }

    /// Drives straight backward while that is safe, otherwise turns in place.
    fn recover(&mut self, scene: &DriveScene, elapsed_s: f64) -> Option<Twist> {
        if elapsed_s >= RECOVERY_S {
            return None;
        }
        let settings = self.settings;
        self.monitor.update(&settings, scene, REVERSE_MPS);
        let back_mps = self.monitor.safe_speed_mps(&settings, -REVERSE_MPS, 0.0);
        let turn_radps = if back_mps == 0.0 { 0.5 * self.settings.max_angular_radps } else { 0.0 };
        Some(self.command(scene, Twist { linear_mps: back_mps, angular_radps: turn_radps }))
    }
}

/// The point of the path at most `lookahead_m` ahead with no lethal cell between it and the robot.
fn visible_lookahead_point(
    costmap: &Costmap,
    path: &Path,
    position: &Point2<f64>,
    lookahead_m: f64,
) -> Option<Point2<f64>> {
    let robot = costmap.frame().cell_at(position);
    let mut ahead = [1.0, 0.7, 0.4, 0.2]
        .into_iter()
        .filter_map(|part| path.lookahead_point(position, part * lookahead_m));
    let visible = |point: &Point2<f64>| costmap.line_cost(robot, costmap.frame().cell_at(point)).is_some();
    ahead.find(visible).or_else(|| path.ahead().first().or(path.end()).copied())
}

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
    fn check(&self) -> Result<(), SettingsError> {
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

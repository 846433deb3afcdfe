//! A robot with two driven wheels: turns in place, drives along arcs.

mod guard;
mod settings;

use crate::{Body, Costmap, Drive, Moves, Path, Scene};
use guard::{Braking, Guard};
use interfaces::{SettingsError, Twist};
use nalgebra::Point2;
pub use settings::DiffDriveSettings;
use std::f64::consts::PI;

/// It goes on driving when it looks along the path up to this part of the angle at which it had to
/// turn in place, so that it does not start turning again at once.
const TURNED: f64 = 0.3;
/// The last bit of a path is driven at least this fast, m/s.
const CREEP_MPS: f64 = 0.05;
/// How long it backs away, and then turns where it cannot, s.
const RECOVERY_S: f64 = 2.0;
/// A tick longer than this does not allow a larger change of speed, s.
const LONGEST_TICK_S: f64 = 0.2;

/// Follows paths by pure pursuit (Coulter 1992) of the farthest point ahead in line of sight, turns
/// in place when the path lies behind, and brakes for what it senses.
#[derive(Clone, Debug)]
pub struct DiffDrive {
    settings: DiffDriveSettings,
    guard: Guard,
    turning: bool,
    last: Twist,
    last_time_s: f64,
}

impl DiffDrive {
    /// A robot at rest.
    ///
    /// # Errors
    ///
    /// When a setting is not a number that makes sense; the error names it.
    pub fn new(settings: DiffDriveSettings) -> Result<Self, SettingsError> {
        settings.check()?;
        let guard = Guard::default();
        Ok(Self { settings, guard, turning: false, last: Twist::STOP, last_time_s: f64::NEG_INFINITY })
    }

    fn braking(&self) -> Braking {
        Braking {
            radius_m: self.settings.radius_m,
            margin_m: self.settings.clearance_m,
            margin_s: self.settings.clearance_s,
            reaction_s: self.settings.reaction_s,
            deceleration_mps2: self.settings.acceleration_mps2,
            others_mps: self.settings.others_mps,
        }
    }

    /// How fast to turn in place by `angle_rad`, so that the turn ends there.
    fn turn_radps(&self, angle_rad: f64) -> f64 {
        // Half of what the robot can do: it hears of its heading once a tick only.
        let brakeable = (self.settings.angular_acceleration_radps2 * angle_rad.abs()).sqrt();
        brakeable.min(self.settings.max_angular_radps).copysign(angle_rad)
    }

    /// Limits how much faster the robot gets within a tick. Slowing down is left to the robot.
    fn command(&mut self, scene: &Scene, wish: Twist) -> Twist {
        let tick_s = (scene.situation.time - self.last_time_s).clamp(0.0, LONGEST_TICK_S);
        let faster = self.settings.acceleration_mps2 * tick_s;
        let turns_more = self.settings.angular_acceleration_radps2 * tick_s;
        let (v, w) = (self.last.linear_mps, self.last.angular_radps);
        self.last = Twist {
            linear_mps: wish.linear_mps.clamp(v.min(0.0) - faster, v.max(0.0) + faster),
            angular_radps: wish.angular_radps.clamp(w.min(0.0) - turns_more, w.max(0.0) + turns_more),
        };
        self.last_time_s = scene.situation.time;
        self.last
    }
}

impl Drive for DiffDrive {
    type Command = Twist;

    fn body(&self) -> Body {
        let DiffDriveSettings { radius_m, tolerance_m, max_linear_mps, .. } = self.settings;
        let stride_m = 2.0 * radius_m;
        let step_s = stride_m / max_linear_mps;
        Body {
            radius_m,
            moves: Moves::Eight,
            speed_mps: max_linear_mps,
            tolerance_m,
            stride_m,
            directions: 16,
            step_s,
            // To turn round, to speed up and to brake.
            step_limit_s: 2.0 * step_s + PI / self.settings.max_angular_radps,
        }
    }

    fn follow(&mut self, scene: &Scene, path: &Path) -> Twist {
        let settings = self.settings;
        let position = scene.situation.position();
        let Some(carrot) = visible_carrot(scene.costmap, path, &position, settings.lookahead_m) else {
            return self.rest(scene);
        };
        let towards = scene.situation.pose.inverse_transform_point(&carrot).coords;
        let off_rad = libm::atan2(towards.y, towards.x);
        let allowed_rad = settings.turn_in_place_rad * if self.turning { TURNED } else { 1.0 };
        self.turning = off_rad.abs() > allowed_rad;
        let turn = Twist { linear_mps: 0.0, angular_radps: self.turn_radps(off_rad) };
        if self.turning {
            return self.command(scene, turn);
        }
        // The arc that starts where the robot looks and leads through the carrot.
        let curvature_radpm = 2.0 * towards.y / towards.norm_squared().max(1e-6);
        let end_mps = (settings.acceleration_mps2 * path.left_m(&position)).sqrt().max(CREEP_MPS);
        let aligned = 1.0 - (off_rad / settings.turn_in_place_rad).abs();
        let wish_mps = (settings.max_linear_mps * aligned.max(0.2))
            .min(end_mps)
            .min(settings.max_angular_radps / curvature_radpm.abs().max(1e-6))
            .min(self.last.linear_mps.max(0.0) + settings.acceleration_mps2 * LONGEST_TICK_S);
        let braking = self.braking();
        self.guard.look(&braking, scene, wish_mps);
        let safe_mps = self.guard.safe_speed_mps(&braking, wish_mps, curvature_radpm);
        if safe_mps == 0.0 {
            return self.command(scene, turn);
        }
        self.command(scene, Twist { linear_mps: safe_mps, angular_radps: safe_mps * curvature_radpm })
    }

    fn rest(&mut self, scene: &Scene) -> Twist {
        self.turning = false;
        self.command(scene, Twist::STOP)
    }

    /// Backs away straight while that is safe, then turns in place.
    fn recover(&mut self, scene: &Scene, elapsed_s: f64) -> Option<Twist> {
        if elapsed_s >= RECOVERY_S {
            return None;
        }
        let braking = self.braking();
        self.guard.look(&braking, scene, self.settings.reverse_mps);
        let back_mps = self.guard.safe_speed_mps(&braking, -self.settings.reverse_mps, 0.0);
        let turn_radps = if back_mps == 0.0 { 0.5 * self.settings.max_angular_radps } else { 0.0 };
        Some(self.command(scene, Twist { linear_mps: back_mps, angular_radps: turn_radps }))
    }
}

/// The point of the path at most `lookahead_m` ahead that nothing closed hides from the robot.
fn visible_carrot(
    costmap: &Costmap,
    path: &Path,
    position: &Point2<f64>,
    lookahead_m: f64,
) -> Option<Point2<f64>> {
    let robot = costmap.frame().cell_at(position);
    let ahead = [1.0, 0.7, 0.4, 0.2].into_iter().filter_map(|part| path.carrot(position, part * lookahead_m));
    let visible = |carrot: &Point2<f64>| costmap.line_cost(robot, costmap.frame().cell_at(carrot)).is_some();
    ahead.into_iter().find(visible).or_else(|| path.ahead().first().or(path.end()).copied())
}

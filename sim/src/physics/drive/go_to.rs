//! The way to a pose, straight on, by odometry.

use crate::physics::command::Velocity;
use crate::physics::spec::{DriveKind, DriveLimits};
use interfaces::wrap_rad;
use nalgebra::{Isometry2, Vector2};

/// Nearer than this it is there, m and rad.
const THERE_M: f64 = 0.01;
const THERE_RAD: f64 = 0.01;
/// The same for a car, which cannot turn in place, m.
const CAR_THERE_M: f64 = 0.05;
/// A robot that can turn in place does so first where the goal is farther off its heading, rad.
const TURN_FIRST_RAD: f64 = 0.3;
/// At the end it slows down in proportion to what is left, 1/s: brakes alone would overshoot.
const SLOW_DOWN_PER_S: f64 = 3.0;

/// The velocity to aim at, at a pose on the way to another one.
pub(super) fn velocity(limits: &DriveLimits, at: &Isometry2<f64>, goal: &Isometry2<f64>) -> Velocity {
    let way = at.inverse_transform_vector(&(goal.translation.vector - at.translation.vector));
    let way_m = way.norm();
    let turn_rad = wrap_rad(interfaces::heading_rad(goal) - interfaces::heading_rad(at));
    let speed_mps = as_fast_as(limits.max_linear_mps, limits.max_linear_acceleration_mps2, way_m);
    let turn = |angle_rad: f64| {
        let most = (limits.max_angular_radps, limits.max_angular_acceleration_radps2);
        let speed_radps =
            if angle_rad.abs() < THERE_RAD { 0.0 } else { as_fast_as(most.0, most.1, angle_rad.abs()) };
        speed_radps.copysign(angle_rad)
    };
    match limits.kind {
        DriveKind::Omni { max_left_mps, max_left_acceleration_mps2 } => {
            let turn_radps = turn(turn_rad);
            if way_m < THERE_M {
                return Velocity { turn_radps, ..Velocity::STOP };
            }
            // So slow that both bounds leave the direction as it is.
            let left_mps = as_fast_as(max_left_mps, max_left_acceleration_mps2, way_m);
            let along = way / way_m;
            let speed_mps = (speed_mps / along.x.abs()).min(left_mps / along.y.abs());
            Velocity { forward_mps: along.x * speed_mps, left_mps: along.y * speed_mps, turn_radps }
        }
        DriveKind::Differential if way_m < THERE_M => {
            Velocity { turn_radps: turn(turn_rad), ..Velocity::STOP }
        }
        DriveKind::Differential => {
            let off_rad = libm::atan2(way.y, way.x);
            if off_rad.abs() > TURN_FIRST_RAD {
                return Velocity { turn_radps: turn(off_rad), ..Velocity::STOP };
            }
            Velocity { forward_mps: speed_mps * libm::cos(off_rad), left_mps: 0.0, turn_radps: turn(off_rad) }
        }
        DriveKind::Car { .. } => car(limits, &way, way_m, speed_mps),
    }
}

/// Pure pursuit (Coulter, 1992): along the circle through the goal; backwards if that lies behind.
fn car(limits: &DriveLimits, way: &Vector2<f64>, way_m: f64, speed_mps: f64) -> Velocity {
    if way_m < CAR_THERE_M {
        return Velocity::STOP;
    }
    let curvature_radpm = 2.0 * way.y / (way_m * way_m);
    let forward_mps = speed_mps.copysign(way.x);
    if curvature_radpm.abs() > limits.max_curvature_radpm() {
        // The goal lies in a circle that it cannot enter: away from it first.
        return Velocity { forward_mps: -limits.max_linear_mps.copysign(way.x), ..Velocity::STOP };
    }
    Velocity { forward_mps, left_mps: 0.0, turn_radps: forward_mps * curvature_radpm }
}

/// As fast as allows to stop within a way, at half of what the brakes can do.
fn as_fast_as(fastest: f64, braking: f64, way: f64) -> f64 {
    fastest.min((braking * way).sqrt()).min(SLOW_DOWN_PER_S * way)
}

//! Driving straight to a pose, by odometry.

use crate::physics::command::Velocity;
use crate::physics::spec::{DriveKind, DriveLimits};
use interfaces::wrap_rad;
use nalgebra::{Isometry2, Vector2};

/// The robot has arrived if it is within this distance and angle, m and rad.
const ARRIVED_M: f64 = 0.01;
const ARRIVED_RAD: f64 = 0.01;
/// A car, which cannot turn in place, has arrived within this distance, m.
const CAR_ARRIVED_M: f64 = 0.05;
/// A robot that can turn in place does so first if the angle between its heading and the goal is larger than this,
/// rad.
const TURN_FIRST_RAD: f64 = 0.3;
/// At the end the speed is proportional to the remaining distance, 1/s: braking alone would overshoot.
const SLOW_DOWN_PER_S: f64 = 3.0;

/// The wanted velocity on the way from the pose `at` to the pose `goal`.
pub(super) fn velocity(limits: &DriveLimits, at: &Isometry2<f64>, goal: &Isometry2<f64>) -> Velocity {
    let offset = at.inverse_transform_vector(&(goal.translation.vector - at.translation.vector));
    let distance_m = offset.norm();
    let turn_rad = wrap_rad(interfaces::heading_rad(goal) - interfaces::heading_rad(at));
    let speed_mps = stopping_speed(limits.max_linear_mps, limits.max_linear_acceleration_mps2, distance_m);
    let turn = |angle_rad: f64| {
        let most = (limits.max_angular_radps, limits.max_angular_acceleration_radps2);
        let speed_radps =
            if angle_rad.abs() < ARRIVED_RAD { 0.0 } else { stopping_speed(most.0, most.1, angle_rad.abs()) };
        speed_radps.copysign(angle_rad)
    };
    match limits.kind {
        DriveKind::Omni { max_left_mps, max_left_acceleration_mps2 } => {
            let turn_radps = turn(turn_rad);
            if distance_m < ARRIVED_M {
                return Velocity { turn_radps, ..Velocity::STOP };
            }
            // Slow enough that neither bound changes the direction.
            let left_mps = stopping_speed(max_left_mps, max_left_acceleration_mps2, distance_m);
            let along = offset / distance_m;
            let speed_mps = (speed_mps / along.x.abs()).min(left_mps / along.y.abs());
            Velocity { forward_mps: along.x * speed_mps, left_mps: along.y * speed_mps, turn_radps }
        }
        DriveKind::Differential if distance_m < ARRIVED_M => {
            Velocity { turn_radps: turn(turn_rad), ..Velocity::STOP }
        }
        DriveKind::Differential => {
            let off_rad = libm::atan2(offset.y, offset.x);
            if off_rad.abs() > TURN_FIRST_RAD {
                return Velocity { turn_radps: turn(off_rad), ..Velocity::STOP };
            }
            Velocity { forward_mps: speed_mps * libm::cos(off_rad), left_mps: 0.0, turn_radps: turn(off_rad) }
        }
        DriveKind::Car { .. } => car(limits, &offset, distance_m, speed_mps),
    }
}

/// Pure pursuit (Coulter, 1992): along the circle through the goal; backward if the goal is behind the car.
fn car(limits: &DriveLimits, offset: &Vector2<f64>, distance_m: f64, speed_mps: f64) -> Velocity {
    if distance_m < CAR_ARRIVED_M {
        return Velocity::STOP;
    }
    let curvature_radpm = 2.0 * offset.y / (distance_m * distance_m);
    let forward_mps = speed_mps.copysign(offset.x);
    if curvature_radpm.abs() > limits.max_curvature_radpm() {
        // The goal is inside a circle that the car cannot enter: first drive away from the goal.
        return Velocity { forward_mps: -limits.max_linear_mps.copysign(offset.x), ..Velocity::STOP };
    }
    Velocity { forward_mps, left_mps: 0.0, turn_radps: forward_mps * curvature_radpm }
}

/// The highest speed from which the robot can stop within a distance, with half of the maximum deceleration.
fn stopping_speed(fastest: f64, braking: f64, distance: f64) -> f64 {
    fastest.min((braking * distance).sqrt()).min(SLOW_DOWN_PER_S * distance)
}

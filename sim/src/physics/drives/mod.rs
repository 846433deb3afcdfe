//! The drives of robots: from a command to the velocity of the next physics step.

use super::command::{Command, Velocity};
use super::spec::{DriveKind, DriveLimits};
use interfaces::{Values, values, wrap_rad};
use nalgebra::{Isometry2, Vector2};

/// A solved velocity that differs from the wanted one by more than this shows a contact, m/s or rad/s. The
/// value is well above the rounding of the physics.
const HELD_BACK: f64 = 1e-4;

/// The motors of a robot. They follow a command as fast as the limits allow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motors {
    limits: DriveLimits,
    /// The present velocity.
    pub(super) velocity: Velocity,
    /// Whether contacts changed the velocity in the last step.
    pub(super) is_stalled: bool,
}

impl Motors {
    /// A drive at rest.
    pub(super) fn new(limits: DriveLimits) -> Self {
        Self { limits, velocity: Velocity::STOP, is_stalled: false }
    }

    /// The values that a snapshot holds.
    pub(super) fn values(&mut self) -> Values<'_> {
        values![self.velocity, self.is_stalled]
    }

    /// The velocity of the next physics step under a command. `at` is the pose by odometry. A command that contains
    /// NaN stops the robot.
    pub(super) fn step(&mut self, command: &Command, at: &Isometry2<f64>, step_s: f64) -> Velocity {
        let (limits, now) = (&self.limits, self.velocity);
        let aim = match command {
            Command::Velocity(velocity) => *velocity,
            Command::Acceleration(gain) => Velocity {
                forward_mps: now.forward_mps + gain.forward_mps2 * step_s,
                left_mps: now.left_mps + gain.left_mps2 * step_s,
                turn_radps: now.turn_radps + gain.turn_radps2 * step_s,
            },
            Command::GoTo(goal) => velocity_to(limits, at, goal),
        };
        let is_nan = aim.forward_mps.is_nan() || aim.left_mps.is_nan() || aim.turn_radps.is_nan();
        let aim = if is_nan { Velocity::STOP } else { aim };
        let follow = |now: f64, aim: f64, (fastest, gain): (f64, f64)| {
            let most = gain * step_s;
            now + (aim.clamp(-fastest, fastest) - now).clamp(-most, most)
        };
        let linear = (limits.max_linear_mps, limits.max_linear_acceleration_mps2);
        let angular = (limits.max_angular_radps, limits.max_angular_acceleration_radps2);
        let forward_mps = follow(now.forward_mps, aim.forward_mps, linear);
        let turn_radps = follow(now.turn_radps, aim.turn_radps, angular);
        self.velocity = match limits.kind {
            DriveKind::Differential => Velocity { forward_mps, left_mps: 0.0, turn_radps },
            DriveKind::Omni { max_left_mps, max_left_acceleration_mps2 } => {
                let left = (max_left_mps, max_left_acceleration_mps2);
                let left_mps = follow(now.left_mps, aim.left_mps, left);
                Velocity { forward_mps, left_mps, turn_radps }
            }
            DriveKind::Car { .. } => {
                let most_radps = limits.max_curvature_radpm() * forward_mps.abs();
                let turn_radps = turn_radps.clamp(-most_radps, most_radps);
                Velocity { forward_mps, left_mps: 0.0, turn_radps }
            }
        };
        self.velocity
    }

    /// Replaces the velocity by the velocity after contacts. A robot that was stopped by a wall must therefore
    /// accelerate again when the wall no longer blocks it.
    pub(super) fn settle(&mut self, solved: &Velocity) -> Velocity {
        let settle = |own: &mut f64, solved: f64, fastest: f64| {
            let is_off = (*own - solved).abs() > HELD_BACK;
            if is_off {
                *own = solved.clamp(-fastest, fastest);
            }
            is_off
        };
        let (limits, own) = (&self.limits, &mut self.velocity);
        let is_held = settle(&mut own.forward_mps, solved.forward_mps, limits.max_linear_mps);
        let is_turned = settle(&mut own.turn_radps, solved.turn_radps, limits.max_angular_radps);
        let is_shifted = match limits.kind {
            DriveKind::Omni { max_left_mps, .. } => settle(&mut own.left_mps, solved.left_mps, max_left_mps),
            // A sideways velocity ends with the step: the wheels do not roll sideways.
            DriveKind::Differential | DriveKind::Car { .. } => false,
        };
        self.is_stalled = is_held || is_turned || is_shifted;
        self.velocity
    }
}

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
fn velocity_to(limits: &DriveLimits, at: &Isometry2<f64>, goal: &Isometry2<f64>) -> Velocity {
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

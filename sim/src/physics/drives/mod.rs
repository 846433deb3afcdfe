//! The drives of robots: from a command to the velocity of the next physics step.

use super::spec::{DriveKind, DriveLimits};
use super::velocity::Velocity;
use interfaces::{Values, values};

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

    /// The velocity of the next physics step under a command. A command that contains NaN stops the robot.
    pub(super) fn step(&mut self, command: &Velocity, step_s: f64) -> Velocity {
        let (limits, now) = (&self.limits, self.velocity);
        let is_nan = command.forward_mps.is_nan() || command.left_mps.is_nan() || command.turn_radps.is_nan();
        let aim = if is_nan { &Velocity::STOP } else { command };
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

//! The drives of robots: from a command to the velocity of the next physics step.
//!
//! Without contacts, a robot moves exactly as its wheels turn. A contact changes its velocity; the wheels then slip, and
//! the floor pulls the robot toward the velocity of the wheels. Per mass, this force is slip / τ with τ = 0.05 s
//! ([`SLIP_S`]), forward and in rotation at most the acceleration limits of the drive, sideways at most
//! `lateral_grip` · g. It is computed from the slip at the start of a step, so that steady states do not depend on the
//! step up to τ; longer steps act like τ equal to the step. With the speed v and the acceleration a of the drive:
//!
//! - At a wall, θ from the heading, a robot slides at min(v cos θ, a τ cos θ / sin² θ) where tan θ ≥ a / (`lateral_grip` · g).
//!   Below this angle the grip is exceeded, and it slides faster, at most at v / cos θ.
//! - A robot of mass m pushes a standing one of mass M sideways at the speed s with
//!   m · min(a, (v − s) / τ) = M · min(s / τ, `lateral_grip` · g).

use super::spec::{DriveKind, DriveLimits};
use interfaces::{Twist, Values, values};
use serde::{Deserialize, Serialize};

/// Standard gravity, for friction on the floor, m/s².
pub(super) const GRAVITY_MPS2: f64 = 9.806_65;

/// A solved velocity that differs from the wanted one by more than this shows a contact, m/s or rad/s. The
/// value is well above the rounding of the physics.
const HELD_BACK: f64 = 1e-4;

/// The slip of wheels decays with this time constant, s: the default physics step, as in the tire model of a
/// relaxation length (0.025 m at 0.5 m/s).
const SLIP_S: f64 = 0.05;

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

    /// The velocity of the next physics step under a command, with the sideways velocity that contacts gave to wheels
    /// that do not roll sideways. A command that contains NaN stops the robot.
    pub(super) fn step(&mut self, command: &Velocity, step_s: f64) -> Velocity {
        let (limits, now) = (&self.limits, self.velocity);
        let is_nan = command.forward_mps.is_nan() || command.left_mps.is_nan() || command.turn_radps.is_nan();
        let aim = if is_nan { &Velocity::STOP } else { command };
        let follow = |now: f64, aim: f64, (fastest, gain): (f64, f64), slips: bool| {
            let (share, most) = (if slips { (step_s / SLIP_S).min(1.0) } else { 1.0 }, gain * step_s);
            let aim = aim.clamp(-fastest, fastest);
            let next = now + (share * (aim - now)).clamp(-most, most);
            if slips && (next - aim).abs() < HELD_BACK { aim } else { next }
        };
        let linear = (limits.max_linear_mps, limits.max_linear_acceleration_mps2);
        let angular = (limits.max_angular_radps, limits.max_angular_acceleration_radps2);
        let forward_mps = follow(now.forward_mps, aim.forward_mps, linear, self.is_stalled);
        let turn_radps = follow(now.turn_radps, aim.turn_radps, angular, self.is_stalled);
        let grip = (0.0, limits.lateral_grip * GRAVITY_MPS2);
        let (left, max_turn_radps) = match limits.kind {
            DriveKind::Differential => (grip, f64::INFINITY),
            DriveKind::Omni { max_left_mps, max_left_acceleration_mps2 } => {
                ((max_left_mps, max_left_acceleration_mps2), f64::INFINITY)
            }
            DriveKind::Car { .. } => (grip, limits.max_curvature_radpm() * forward_mps.abs()),
        };
        let left_mps = follow(now.left_mps, aim.left_mps, left, self.is_stalled || !limits.is_omni());
        let turn_radps = turn_radps.clamp(-max_turn_radps, max_turn_radps);
        self.velocity = Velocity { forward_mps, left_mps, turn_radps };
        self.velocity
    }

    /// The velocity that the motors reach in the end under a command, if nothing holds the robot back.
    pub(super) fn reached(&self, command: &Velocity) -> Velocity {
        const LONG_ENOUGH_S: f64 = 1e9;
        Self::new(self.limits).step(command, LONG_ENOUGH_S)
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
        let is_shifted = settle(&mut own.left_mps, solved.left_mps, limits.fastest_mps());
        self.is_stalled = is_held || is_turned || is_shifted && limits.is_omni();
        self.velocity
    }
}

/// A velocity in the frame of the robot. As a command, it is valid until the next command, and limited to the maximum velocity
/// and acceleration of the robot. A command that contains NaN stops the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Velocity {
    /// Linear velocity forward, m/s.
    pub forward_mps: f64,
    /// Linear velocity to the left, m/s. Of other drives than omni drives: 0 as a command, and unless a contact pushes
    /// the robot sideways.
    pub left_mps: f64,
    /// Angular velocity, counter-clockwise, rad/s.
    pub turn_radps: f64,
}

impl Velocity {
    /// Zero velocity.
    pub const STOP: Self = Self { forward_mps: 0.0, left_mps: 0.0, turn_radps: 0.0 };

    /// The same velocity without the component to the left.
    pub fn twist(&self) -> Twist {
        Twist { linear_mps: self.forward_mps, angular_radps: self.turn_radps }
    }
}

impl From<Twist> for Velocity {
    fn from(twist: Twist) -> Self {
        Self { forward_mps: twist.linear_mps, left_mps: 0.0, turn_radps: twist.angular_radps }
    }
}

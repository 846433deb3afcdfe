use interfaces::Twist;
use nalgebra::Isometry2;
use serde::{Deserialize, Serialize};

/// A velocity in a robot's own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Velocity {
    /// Forwards, m/s.
    pub forward_mps: f64,
    /// To the left, m/s; only an omni drive has any.
    pub left_mps: f64,
    /// Counter-clockwise, rad/s.
    pub turn_radps: f64,
}

impl Velocity {
    /// Standing still.
    pub const STOP: Self = Self { forward_mps: 0.0, left_mps: 0.0, turn_radps: 0.0 };

    /// The same without the velocity to the left.
    pub fn twist(&self) -> Twist {
        Twist { linear_mps: self.forward_mps, angular_radps: self.turn_radps }
    }
}

impl From<Twist> for Velocity {
    fn from(twist: Twist) -> Self {
        Self { forward_mps: twist.linear_mps, left_mps: 0.0, turn_radps: twist.angular_radps }
    }
}

/// An acceleration in a robot's own frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Acceleration {
    /// Forwards, m/s².
    pub forward_mps2: f64,
    /// To the left, m/s²; only an omni drive has any.
    pub left_mps2: f64,
    /// Counter-clockwise, rad/s².
    pub turn_radps2: f64,
}

/// A command to a robot. It holds until the next command. The bounds of the velocity and the acceleration of
/// the robot hold for every command. A command that is not a number stops the robot.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub enum Command {
    /// To move at this velocity.
    Velocity(Velocity),
    /// To change its velocity at this rate.
    Acceleration(Acceleration),
    /// To drive straight to this pose by odometry, and to stop there to within 0.01 m and 0.01 rad, without
    /// regard to obstacles. A car stops within 0.05 m, with any heading.
    GoTo(#[serde(with = "interfaces::serde_pose")] Isometry2<f64>),
}

impl Command {
    /// To stand still.
    pub const STOP: Self = Self::Velocity(Velocity::STOP);
}

impl From<Twist> for Command {
    fn from(twist: Twist) -> Self {
        Self::Velocity(twist.into())
    }
}

impl From<Velocity> for Command {
    fn from(velocity: Velocity) -> Self {
        Self::Velocity(velocity)
    }
}

impl From<Acceleration> for Command {
    fn from(acceleration: Acceleration) -> Self {
        Self::Acceleration(acceleration)
    }
}

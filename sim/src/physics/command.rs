use interfaces::Twist;
use nalgebra::Isometry2;
use serde::{Deserialize, Serialize};

/// A velocity in the frame of the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Velocity {
    /// Linear velocity forward, m/s.
    pub forward_mps: f64,
    /// Linear velocity to the left, m/s; 0 unless the drive is an omni drive.
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

/// An acceleration in the frame of the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Acceleration {
    /// Linear acceleration forward, m/s².
    pub forward_mps2: f64,
    /// Linear acceleration to the left, m/s²; 0 unless the drive is an omni drive.
    pub left_mps2: f64,
    /// Angular acceleration, counter-clockwise, rad/s².
    pub turn_radps2: f64,
}

/// A command to a robot. The command is valid until the next command. Every command is limited to the maximum
/// velocity and acceleration of the robot. A command that contains NaN stops the robot.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub enum Command {
    /// Move at this velocity.
    Velocity(Velocity),
    /// Change the velocity at this rate.
    Acceleration(Acceleration),
    /// Drive straight to this pose by odometry, and stop there with an error of at most 0.01 m and 0.01 rad.
    /// Obstacles are ignored. A car stops within 0.05 m, with any heading.
    GoTo(#[serde(with = "interfaces::serde_pose")] Isometry2<f64>),
}

impl Command {
    /// Stop.
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

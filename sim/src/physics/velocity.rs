use interfaces::Twist;
use serde::{Deserialize, Serialize};

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

/// The velocity of a diff-drive robot in its own frame, as ROS `geometry_msgs/Twist`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Forwards, m/s.
    pub linear_mps: f64,
    /// Counter-clockwise, rad/s.
    pub angular_radps: f64,
}

impl Twist {
    /// Standing still.
    pub const STOP: Self = Self { linear_mps: 0.0, angular_radps: 0.0 };
}

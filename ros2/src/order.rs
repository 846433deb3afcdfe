//! What a robot is asked to do.

use interfaces::Twist;
use nalgebra::Isometry2;

/// What the node asks of the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Order {
    /// Nothing.
    #[default]
    None,
    /// To drive at a velocity until the next order.
    Velocity(Twist),
    /// To drive to a pose in the frame of the map.
    Goal(Isometry2<f64>),
    /// To give up the goal.
    Cancel,
}

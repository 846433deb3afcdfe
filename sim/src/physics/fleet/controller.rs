use crate::physics::command::Command;
use crate::physics::robot::RobotView;
use interfaces::LaserReading;

/// A controller of driven robots: any type, or a closure that takes a robot and the reading of its main laser and
/// returns a velocity ([`interfaces::Twist`]) or any other [`Command`].
///
/// The fleet calls the controller at every scan of the main laser of a driven robot. Sensors that the controller does
/// not read are not simulated. The controller `&mut ()` gives no commands: the robots keep the command of
/// [`Fleet::command`](super::Fleet::command).
pub trait Controller {
    /// The new command; `None` if the robot keeps its command. The readings of all sensors are in the view of the
    /// robot. A command that contains NaN stops the robot; a command beyond the limits of the drive is limited to
    /// them.
    fn drive(&mut self, robot: &RobotView<'_>) -> Option<Command>;
}

impl<F, C> Controller for F
where
    F: FnMut(&RobotView<'_>, &LaserReading) -> C,
    C: Into<Command>,
{
    fn drive(&mut self, robot: &RobotView<'_>) -> Option<Command> {
        Some(self(robot, robot.reading()?).into())
    }
}

impl Controller for () {
    fn drive(&mut self, _: &RobotView<'_>) -> Option<Command> {
        None
    }
}

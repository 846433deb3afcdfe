use crate::physics::command::Command;
use crate::physics::robot::RobotView;
use interfaces::LaserReading;

/// A controller of driven robots: any type, or a closure from a robot and the reading of its main laser to a
/// velocity ([`interfaces::Twist`]) or any other [`Command`].
///
/// The fleet calls it at every scan of the main laser of a robot. `&mut ()` gives no commands: robots keep the
/// command of [`Fleet::command`](super::Fleet::command).
pub trait Controller {
    /// The command from now on; `None`: the robot keeps its command. The readings of all other sensors are in
    /// the view of the robot. A command that is not a number stops the robot; one beyond the bounds of the robot
    /// is cut to them.
    fn drive(&mut self, robot: &RobotView<'_>, reading: &LaserReading) -> Option<Command>;
}

impl<F, C> Controller for F
where
    F: FnMut(&RobotView<'_>, &LaserReading) -> C,
    C: Into<Command>,
{
    fn drive(&mut self, robot: &RobotView<'_>, reading: &LaserReading) -> Option<Command> {
        Some(self(robot, reading).into())
    }
}

impl Controller for () {
    fn drive(&mut self, _: &RobotView<'_>, _: &LaserReading) -> Option<Command> {
        None
    }
}

use crate::physics::command::Command;
use crate::physics::report::RobotView;
use geometry::{LaserReading, Twist};

/// What tells driven robots where to go: any type, or a closure from a robot (by its place in the
/// world file) and its reading to a command.
pub trait Controller {
    /// What the robot is to do from this reading on until its next one. Not a number stops it;
    /// what is beyond its bounds is cut to them.
    fn command(&mut self, robot: usize, reading: &LaserReading) -> Twist;

    /// The same for any kind of command, from the reading of the robot's main laser and all else
    /// that it could know: that is asked for, and as a rule asks [`Controller::command`].
    fn drive(&mut self, robot: &RobotView<'_>, reading: &LaserReading) -> Command {
        self.command(robot.index, reading).into()
    }
}

impl<F: FnMut(usize, &LaserReading) -> Twist> Controller for F {
    fn command(&mut self, robot: usize, reading: &LaserReading) -> Twist {
        self(robot, reading)
    }
}

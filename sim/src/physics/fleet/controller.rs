use crate::physics::command::Command;
use crate::physics::report::RobotView;
use interfaces::LaserReading;

/// What tells driven robots where to go: any type, or a closure from a robot and the reading of its
/// main laser to a velocity ([`interfaces::Twist`]) or any other [`Command`].
///
/// It is asked at every scan of the robot's main laser. `&mut ()` has nothing to say: robots go on
/// with what [`Fleet::command`](super::Fleet::command) told them.
pub trait Controller {
    /// What the robot is to do from now on; `None`: what it does already. All else that it senses is in
    /// its view. Not a number stops it; what is beyond its bounds is cut to them.
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

/// A world with one robot. Neither method can fail.
pub trait World {
    /// A reading of the sensors of the robot.
    type Reading;
    /// A command to the robot.
    type Command;

    /// The present reading. No time passes.
    fn sense(&mut self) -> Self::Reading;

    /// Executes `command` until the next reading is due. A command that is not a number stops the robot; one beyond
    /// its bounds is cut to them.
    fn act(&mut self, command: &Self::Command);
}

/// A world with one robot. No method returns an error.
pub trait World {
    /// A reading of the sensors of the robot.
    type Reading;
    /// A command to the robot.
    type Command;

    /// The reading of the sensors at the present time. No time passes.
    fn sense(&mut self) -> Self::Reading;

    /// Whether the poses of readings are exact; `false`: they are those of an odometry with errors.
    fn poses_are_exact(&self) -> bool;

    /// Executes `command` until the next reading is due. A command that contains NaN stops the robot; a command
    /// beyond the limits of the drive is limited to them.
    fn act(&mut self, command: &Self::Command);
}

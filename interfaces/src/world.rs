/// A place that a robot lives in: two verbs, and no way to fail.
pub trait World {
    /// What the robot senses.
    type Reading;
    /// What the robot can be told to do.
    type Command;

    /// What the robot senses now. No time passes.
    fn sense(&mut self) -> Self::Reading;

    /// Obeys `command` until the next reading is due. A command that is not a number stops the
    /// robot; one beyond its bounds is cut to them.
    fn act(&mut self, command: &Self::Command);
}

/// How important a [`Message`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// A decision of the robot.
    Decision,
    /// A change in the world, or the detection of a change.
    Event,
    /// A failure: a goal that was given up, a collision.
    Trouble,
}

/// A line of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// How important the message is.
    pub level: Level,
    /// One sentence.
    pub text: String,
}

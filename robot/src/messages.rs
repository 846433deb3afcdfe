/// The importance of a [`Message`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
pub enum Level {
    /// A decision of the robot.
    Decision,
    /// A change in the world, or the detection of a change.
    Event,
    /// A failure: a goal that was given up, a collision.
    Trouble,
}

/// A message of the log.
#[derive(Clone, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
pub struct Message {
    /// The importance of the message.
    pub level: Level,
    /// One sentence.
    pub text: String,
}

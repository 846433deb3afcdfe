//! A message of a bag, and what its topic is to us.

use crate::summary::LogError;
use std::sync::Arc;

/// A topic of a bag.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Topic {
    /// Its name, as written.
    pub(super) name: String,
    /// The type of its messages, as written: `sensor_msgs/msg/LaserScan`.
    pub(super) type_name: String,
    /// The encoding of its messages.
    pub(super) encoding: String,
}

/// A part of a bag, or why the bag cannot be used.
pub(super) type Usable<T> = Result<T, String>;

/// Whether the messages of a topic are wanted; others are skipped.
pub(super) type IsWanted = Arc<dyn Fn(&Topic) -> bool + Send + Sync>;

/// A message.
#[derive(Clone, Debug)]
pub(super) struct Message {
    pub(super) topic: Arc<Topic>,
    /// The time at which it was recorded, ns.
    pub(super) log_ns: i64,
    pub(super) data: Vec<u8>,
    pub(super) file: Arc<str>,
    /// Its number among the messages of its topic in the file, from 1.
    pub(super) number: u64,
}

impl Message {
    /// The error for this message.
    pub(super) fn error(&self, what: String) -> LogError {
        let why = format!("message {} of {}: {what}", self.number, self.topic.name);
        LogError::Unusable { file: self.file.to_string(), why }
    }
}

/// The messages of one file, in the order of the file.
pub(super) trait MessageSource {
    /// The next message that is wanted.
    fn next_message(&mut self) -> Result<Option<Message>, LogError>;

    /// All topics that were found so far, and after the last message what is missing in the file.
    fn report(&self) -> (Vec<Arc<Topic>>, Option<String>);
}

/// What the messages of a topic are to us.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Scans,
    Odometry,
    Transforms,
}

impl Kind {
    /// The kind of a topic by the type of its messages; `None` for all others.
    pub(super) fn of(topic: &Topic) -> Option<Self> {
        // Types of ROS 1 have the same names without `msg`; what has their encoding is named in an error.
        let kind = match topic.type_name.replacen("/msg/", "/", 1).as_str() {
            "sensor_msgs/LaserScan" => Self::Scans,
            "nav_msgs/Odometry" => Self::Odometry,
            "tf2_msgs/TFMessage" => Self::Transforms,
            _ => return None,
        };
        // Other topics of transforms are those of tools, or copies.
        let is_tf = matches!(topic.name.rsplit('/').next(), Some("tf" | "tf_static"));
        (kind != Self::Transforms || is_tf).then_some(kind)
    }

    /// The kind of a topic that can be read.
    pub(super) fn of_readable(topic: &Topic) -> Option<Self> {
        Self::of(topic).filter(|_| topic.encoding == "cdr")
    }
}

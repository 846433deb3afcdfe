//! A message of a bag, its topic, and what gives messages.

use crate::error::LogError;
use std::sync::Arc;

/// A topic of a bag.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Topic {
    /// Its name, as written.
    pub(crate) name: String,
    /// The type of its messages, as written: `sensor_msgs/msg/LaserScan`.
    pub(crate) type_name: String,
    /// The encoding of its messages.
    pub(crate) encoding: String,
}

/// What a pass over a bag needs.
#[derive(Clone)]
pub(crate) struct Selection {
    /// Whether the messages of a topic are wanted; others are skipped.
    pub(crate) is_wanted: Arc<dyn Fn(&Topic) -> bool + Send + Sync>,
    /// Whether checksums are compared: once is enough, and it takes a third of the time of a pass.
    pub(crate) checks_sums: bool,
}

/// A message.
#[derive(Clone, Debug)]
pub(crate) struct Message {
    pub(crate) topic: Arc<Topic>,
    /// The time at which it was recorded, ns.
    pub(crate) log_ns: i64,
    pub(crate) data: Vec<u8>,
    pub(crate) file: Arc<str>,
    /// Its number among the messages of its topic in the file, from 1.
    pub(crate) number: u64,
}

impl Message {
    /// The error for this message.
    pub(crate) fn error(&self, what: String) -> LogError {
        LogError::Message {
            file: self.file.to_string(),
            topic: self.topic.name.clone(),
            number: self.number,
            what,
        }
    }
}

/// The messages of one file, in the order of the file.
pub(crate) trait MessageSource {
    /// The next message that is wanted.
    fn next_message(&mut self) -> Result<Option<Message>, LogError>;

    /// All topics that were found so far, and after the last message what is missing in the file.
    fn report(&self) -> (Vec<Arc<Topic>>, Option<String>);
}

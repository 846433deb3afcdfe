//! `/rosout`: what the node says, for the log of all nodes.

use super::CuriousNode;
use crate::link::Link;
use crate::message::{Log, Message, Time, Topic};
use crate::notes::Severity;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

impl<L: Link> CuriousNode<L> {
    /// The time by the clock of the robot: that of the last reading and the time since it. Before the first reading, it is that of the
    /// computer, or 0 if the clock is simulated.
    pub(super) fn stamp(&self, now: Instant) -> Time {
        let since_ns = |at: Instant| i64::try_from(now.duration_since(at).as_nanos()).unwrap_or(0);
        match self.last {
            Some((stamp, at)) => Time::from_ns(stamp.ns().saturating_add(since_ns(at))),
            None if self.parameters.use_sim_time => Time::default(),
            None => {
                let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
                Time::from_ns(i64::try_from(since_epoch.as_nanos()).unwrap_or(0))
            }
        }
    }

    /// Publishes what was said since the last call.
    pub(super) fn publish_log(&mut self, now: Instant) {
        let unsent = self.notes.take_unsent();
        if unsent.is_empty() {
            return;
        }
        // As rclcpp names a logger.
        let (stamp, name) = (self.stamp(now), self.link.node().trim_start_matches('/').replace('/', "."));
        for (severity, msg) in unsent {
            let level = match severity {
                Severity::Info => Log::INFO,
                Severity::Warning => Log::WARNING,
            };
            let name = name.clone();
            let log = Log { stamp, level, name, msg, file: String::new(), function: String::new(), line: 0 };
            self.link.send(Topic::Log, Message::Log(log));
        }
    }
}

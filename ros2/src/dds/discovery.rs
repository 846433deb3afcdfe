//! Publishers that this node cannot hear, though they use its topics.

use crate::link::Wiring;
use crate::message::{Quality, Topic};
use ros2_client::Context;
use ros2_client::dds::rustdds::policy::Reliability;
use std::time::{Duration, Instant};

/// The time between two looks.
const EVERY: Duration = Duration::from_secs(2);

/// Looks at all publishers now and then.
pub(super) struct Discovery {
    context: Context,
    subscribed: Vec<(Topic, String, Quality)>,
    next: Instant,
}

impl Discovery {
    pub(super) fn new(context: Context, wiring: &Wiring) -> Self {
        Self { context, subscribed: wiring.subscribed.clone(), next: Instant::now() + EVERY }
    }

    /// The publishers that cannot be heard, each in a sentence; none if it is not yet time to look again.
    pub(super) fn problems(&mut self) -> Vec<String> {
        if Instant::now() < self.next {
            return Vec::new();
        }
        self.next = Instant::now() + EVERY;
        let mut problems = Vec::new();
        for writer in self.context.domain_participant().discovered_writers() {
            let found = &writer.publication_topic_data;
            let name = found.topic_name.strip_prefix("rt").unwrap_or_default();
            let mine = self.subscribed.iter().filter(|(_, mine, _)| mine == name);
            let mine: Vec<_> = mine.map(|(topic, _, quality)| (dds_type(*topic), quality)).collect();
            let Some((expected, _)) = mine.first() else { continue };
            match mine.iter().find(|(expected, _)| *expected == found.type_name) {
                None => problems.push(format!(
                    "a publisher of `{name}` has the type {}, not {}: it is ignored",
                    ros_type(&found.type_name),
                    ros_type(expected)
                )),
                Some((_, quality)) => {
                    let is_reliable = matches!(found.qos().reliability(), Some(Reliability::Reliable { .. }));
                    if quality.is_reliable && !is_reliable {
                        problems.push(format!(
                            "a publisher of `{name}` is not reliable, and this node asks for that: it is not heard"
                        ));
                    }
                }
            }
        }
        problems
    }
}

/// The type of a topic on the wire.
pub(super) fn dds_type(topic: Topic) -> String {
    let (package, kind) = topic.type_name();
    format!("{package}::msg::dds_::{kind}_")
}

/// A type as ROS writes it: `sensor_msgs/msg/LaserScan` for `sensor_msgs::msg::dds_::LaserScan_`.
pub(super) fn ros_type(dds: &str) -> String {
    dds.replace("::dds_::", "/").replace("::", "/").trim_end_matches('_').to_owned()
}

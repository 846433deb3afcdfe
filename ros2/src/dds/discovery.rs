//! Publishers that this node cannot hear, though they use its topics.

use crate::message::{Quality, Topic};
use ros2_client::dds::rustdds::EndpointDescription;
use ros2_client::dds::rustdds::policy::Reliability;

/// A topic with its full name.
pub(super) type Named = (Topic, String, Quality);

/// Why a publisher cannot be heard by a node with these subscriptions, in a sentence; `None` if it can, or has another topic.
pub(super) fn problem(subscribed: &[Named], found: &EndpointDescription) -> Option<String> {
    let name = found.topic_name.strip_prefix("rt")?;
    let mine = || subscribed.iter().filter(|(_, mine, _)| mine == name);
    let (expected, ..) = mine().next()?;
    let Some((.., quality)) = mine().find(|(topic, ..)| dds_type(*topic) == found.type_name) else {
        let (found, expected) = (ros_type(&found.type_name), ros_type(&dds_type(*expected)));
        return Some(format!("a publisher of `{name}` has the type {found}, not {expected}: it is ignored"));
    };
    let is_reliable = matches!(found.qos.reliability(), Some(Reliability::Reliable { .. }));
    (quality.is_reliable && !is_reliable).then(|| {
        format!("a publisher of `{name}` is not reliable, and this node asks for that: it is not heard")
    })
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

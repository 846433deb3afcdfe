//! What the topics of a bag are to us.

use super::message::Topic;

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

/// What to use of a bag. By default, everything is found by the types of the topics and by the frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TopicChoice {
    /// The topics of the scans; all if empty.
    pub scan_topics: Vec<String>,
    /// The topic of the odometry; needed where a bag has several.
    pub odom_topic: Option<String>,
    /// The frame of the robot; by default the frame whose pose the odometry gives.
    pub base_frame: Option<String>,
}

/// A name of a frame or a topic without its leading slash: ROS 1 wrote it, ROS 2 does not.
pub(crate) fn bare(name: &str) -> &str {
    name.trim_start_matches('/')
}

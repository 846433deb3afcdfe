/// What to use of a log. By default, everything in a bag is found by the types of the topics and by the frames, and the poses are
/// those of the odometry.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct TopicChoice {
    /// The topics of the scans; all if empty.
    pub scan_topics: Vec<String>,
    /// The topic of the odometry; needed where a bag has several.
    pub odom_topic: Option<String>,
    /// The frame of the robot; by default the frame whose pose the odometry gives.
    pub base_frame: Option<String>,
    /// Whether the poses are those of another SLAM instead of the odometry: in a bag those of tf from `map_frame` to the robot, in a
    /// CARMEN log those of the FLASER lines.
    pub is_corrected: bool,
    /// The frame of the map of this SLAM; by default `map`.
    pub map_frame: Option<String>,
}

/// A name of a frame or a topic without its leading slash: ROS 1 wrote it, ROS 2 does not.
pub(crate) fn bare(name: &str) -> &str {
    name.trim_start_matches('/')
}

/// Names for a sentence, at most ten.
pub(crate) fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    const MAX: usize = 10;
    let mut names: Vec<String> = names.map(str::to_owned).collect();
    names.sort();
    names.dedup();
    let more = names.len().saturating_sub(MAX);
    names.truncate(MAX);
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    names.join(", ") + &rest
}

//! Bags without scans of a plane: what they have instead, and what can be done.

use super::kind::Kind;
use super::message::Topic;
use crate::choice::listed;
use std::sync::Arc;

/// Why a bag with these topics has no scan.
pub(super) fn no_scans(topics: &[Arc<Topic>]) -> String {
    if topics.is_empty() {
        return "no message: the bag is empty".to_owned();
    }
    if topics.iter().any(|topic| Kind::of(topic) == Some(Kind::Scans) && topic.encoding != "cdr") {
        let encodings = listed(topics.iter().map(|topic| match Kind::of(topic) {
            Some(Kind::Scans) => topic.encoding.as_str(),
            _ => topic.type_name.as_str(),
        }));
        return format!("the scans are not encoded as cdr, which is what is read; there are {encodings}");
    }
    let of = |type_name: &str| {
        let is = |topic: &&Arc<Topic>| topic.type_name.replacen("/msg/", "/", 1) == type_name;
        topics.iter().filter(is).map(|topic| topic.name.as_str()).collect::<Vec<_>>()
    };
    let (clouds, echoes) = (of("sensor_msgs/PointCloud2"), of("sensor_msgs/MultiEchoLaserScan"));
    if let Some(first) = clouds.first() {
        return format!(
            "no scan of a plane (sensor_msgs/msg/LaserScan), but points in 3D (sensor_msgs/msg/PointCloud2 on {}), which are not \
             read: play the bag through `ros2 run pointcloud_to_laserscan pointcloud_to_laserscan_node --ros-args -r \
             cloud_in:={first} -p target_frame:=base_link -p min_height:=0.1 -p max_height:=0.5`, and record /scan, /tf, \
             /tf_static and the odometry (`ros2 bag record`)",
            listed(clouds.iter().copied())
        );
    }
    if let Some(first) = echoes.first() {
        return format!(
            "no scan of one echo (sensor_msgs/msg/LaserScan), but of several (sensor_msgs/msg/MultiEchoLaserScan on {}), which are \
             not read: play the bag through `ros2 run laser_proc laser_proc_node --ros-args -r echoes:={first}`, and record \
             /first, /tf, /tf_static and the odometry (`ros2 bag record`)",
            listed(echoes.iter().copied())
        );
    }
    let types = listed(topics.iter().map(|topic| topic.type_name.as_str()));
    format!("no message of sensor_msgs/msg/LaserScan; there are {types}")
}

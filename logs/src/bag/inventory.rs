//! The first pass over a bag: which topics and frames there are.

use super::files::BagFile;
use super::message::{Kind, Message, Topic, Usable};
use super::messages::{Messages, RecordedOrder};
use crate::assemble::Frames;
use crate::bounds;
use crate::summary::{LogError, bare, listed};
use ros::{Header, Odometry, Transforms, cdr};
use serde::Deserialize;
use std::sync::Arc;

/// A message of a scan up to its header.
#[derive(Deserialize)]
struct Stamped {
    header: Header,
}

/// What is known of one laser: the frame of scans on a topic.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LaserTopic {
    pub(super) topic: String,
    pub(super) frame: String,
    pub(super) scans: usize,
}

/// What is known of a topic of odometry.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OdometryTopic {
    pub(super) topic: String,
    pub(super) odom_frame: String,
    pub(super) child_frame: String,
}

/// What a bag contains.
#[derive(Default)]
pub(super) struct Inventory {
    pub(super) lasers: Vec<LaserTopic>,
    pub(super) odometry: Vec<OdometryTopic>,
    /// With the first pose of each transform.
    pub(super) frames: Frames,
    /// The stamp and the time of recording of the first scan, ns.
    pub(super) begin_ns: Option<(i64, i64)>,
    /// The time of recording of the last scan, ns.
    pub(super) end_ns: i64,
    pub(super) order: RecordedOrder,
    pub(super) topics: Vec<Arc<Topic>>,
    pub(super) notes: Vec<String>,
}

/// The most lasers, or topics of odometry.
const MAX_SOURCES: usize = 64;

impl Inventory {
    pub(super) fn of(files: &[BagFile]) -> Result<Self, LogError> {
        let is_wanted = Arc::new(|topic: &Topic| Kind::of_readable(topic).is_some());
        let mut messages = Messages::new(files.to_vec(), is_wanted);
        let mut inventory = Self::default();
        while let Some(message) = messages.next_message()? {
            inventory.order.note(&message);
            let counted = match Kind::of(&message.topic) {
                Some(Kind::Scans) => inventory.count_scan(&message),
                Some(Kind::Odometry) => inventory.count_odometry(&message),
                Some(Kind::Transforms) => inventory.count_transforms(&message),
                None => Ok(()),
            };
            counted.map_err(|what| message.error(what))?;
        }
        inventory.frames.rewind();
        inventory.topics = messages.topics;
        inventory.notes = messages.notes;
        Ok(inventory)
    }

    fn count_scan(&mut self, message: &Message) -> Usable<()> {
        let Stamped { header } = cdr::decoded(&message.data)?;
        self.begin_ns.get_or_insert((header.stamp.ns(), message.log_ns));
        self.end_ns = message.log_ns;
        let (topic, frame) = (&message.topic.name, bounds::name("a frame", bare(&header.frame_id))?);
        let is_full = self.lasers.len() == MAX_SOURCES;
        match self.lasers.iter_mut().find(|laser| laser.topic == *topic && laser.frame == frame) {
            Some(laser) => laser.scans += 1,
            None if is_full => return Err(format!("more than {MAX_SOURCES} lasers")),
            None => self.lasers.push(LaserTopic { topic: topic.clone(), frame: frame.to_owned(), scans: 1 }),
        }
        Ok(())
    }

    fn count_odometry(&mut self, message: &Message) -> Usable<()> {
        let Odometry { header, child_frame_id, .. } = cdr::decoded(&message.data)?;
        let topic = &message.topic.name;
        if self.odometry.iter().any(|odometry| odometry.topic == *topic) {
            return Ok(());
        }
        if self.odometry.len() == MAX_SOURCES {
            return Err(format!("more than {MAX_SOURCES} topics of odometry"));
        }
        self.odometry.push(OdometryTopic {
            topic: topic.clone(),
            odom_frame: bounds::name("a frame", bare(&header.frame_id))?.to_owned(),
            child_frame: bounds::name("a frame", bare(&child_frame_id))?.to_owned(),
        });
        Ok(())
    }

    fn count_transforms(&mut self, message: &Message) -> Usable<()> {
        let Transforms { transforms } = cdr::decoded(&message.data)?;
        for transform in transforms {
            let (parent, child) = (&transform.header.frame_id, &transform.child_frame_id);
            if let Some(pose) = transform.transform.isometry() {
                self.frames.set(parent, child, pose)?;
            }
        }
        Ok(())
    }
}

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
    let silent = || topics.iter().filter(|topic| Kind::of(topic) == Some(Kind::Scans));
    if silent().next().is_some() {
        let names = listed(silent().map(|topic| topic.name.as_str()));
        return format!(
            "no message of sensor_msgs/msg/LaserScan on {names}: was the laser's driver running?"
        );
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
    format!(
        "no message of sensor_msgs/msg/LaserScan, encoded as cdr, which is what is read; there are {types}"
    )
}

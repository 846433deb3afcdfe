//! The channels of an MCAP file: a topic with its schema, made when its first message comes.

use super::schemas;
use super::sorted::HeldBack;
use crate::cdr;
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{Compression, WriteOptions, Writer};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::{Error, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The quality of service of topics that hold until the next message, in the form of rosbag2: reliable, transient local, and
/// no limits of time.
const LATCHED: &str = "\
- history: 1
  depth: 1
  reliability: 1
  durability: 1
  deadline: {sec: 9223372036, nsec: 854775807}
  lifespan: {sec: 9223372036, nsec: 854775807}
  liveliness: 1
  liveliness_lease_duration: {sec: 9223372036, nsec: 854775807}
  avoid_ros_namespace_conventions: false
";

/// The channels of a file that is being written.
pub(super) struct Channels<W: Write> {
    writer: Writer<NoSeek<HeldBack<W>>>,
    /// Holds back what is written from now on.
    is_end: Arc<AtomicBool>,
    name: String,
    /// The number of each topic, and of its messages.
    known: BTreeMap<String, (u16, u32)>,
}

impl<W: Write> Channels<W> {
    pub(super) fn new(to: W, name: &str) -> Result<Self, Error> {
        let options = WriteOptions::library(WriteOptions::new().profile("ros2"), "curious")
            .compression(Some(Compression::Zstd))
            .disable_seeking(true);
        let (to, is_end) = HeldBack::new(to);
        let writer = options.create(NoSeek::new(to)).map_err(|error| failed(name, error))?;
        Ok(Self { writer, is_end, name: name.to_owned(), known: BTreeMap::new() })
    }

    /// Writes a message of a type like `nav_msgs/Path`.
    pub(super) fn write<T: Serialize>(
        &mut self,
        topic: &str,
        type_name: &str,
        ns: i64,
        message: &T,
    ) -> Result<(), Error> {
        let (channel_id, sequence) = match self.known.get_mut(topic) {
            Some((id, count)) => {
                *count = count.wrapping_add(1);
                (*id, *count)
            }
            None => {
                let id = self.add(topic, type_name)?;
                self.known.insert(topic.to_owned(), (id, 0));
                (id, 0)
            }
        };
        let log_time = u64::try_from(ns).unwrap_or(0);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        let data = cdr::encoded(message).map_err(|what| failed(&self.name, Error::other(what).into()))?;
        self.writer.write_to_known_channel(&header, &data).map_err(|error| failed(&self.name, error))
    }

    fn add(&mut self, topic: &str, type_name: &str) -> Result<u16, Error> {
        let full_name = type_name.replacen('/', "/msg/", 1);
        let definition = schemas::definition(type_name);
        let mut metadata = BTreeMap::new();
        if topic == "/tf_static" || type_name == "nav_msgs/OccupancyGrid" {
            metadata.insert("offered_qos_profiles".to_owned(), LATCHED.to_owned());
        }
        let mut add = || {
            let schema = self.writer.add_schema(&full_name, "ros2msg", definition.as_bytes())?;
            self.writer.add_channel(schema, topic, "cdr", &metadata)
        };
        add().map_err(|error| failed(&self.name, error))
    }

    pub(super) fn finish(mut self) -> Result<W, Error> {
        self.writer.flush().map_err(|error| failed(&self.name, error))?;
        self.is_end.store(true, Ordering::Relaxed);
        self.writer.finish().map_err(|error| failed(&self.name, error))?;
        self.writer.into_inner().into_inner().finish().map_err(|error| failed(&self.name, error.into()))
    }
}

fn failed(name: &str, error: mcap::McapError) -> Error {
    let why = match error {
        mcap::McapError::Io(why) => why,
        other => Error::other(other),
    };
    Error::new(why.kind(), format!("{name}: {why}"))
}

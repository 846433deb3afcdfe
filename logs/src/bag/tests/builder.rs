//! Bags for tests, written by the crate `mcap` and by SQLite itself.

use crate::Log;
use crate::bag::{Bag, BagFile};
use crate::bytes::Bytes;
use crate::summary::{LogError, TopicChoice};
use interfaces::LaserReading;
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions};
use ros::cdr::encoded;
use ros::{
    Header, LaserScan, Odometry, Pose, PoseWithCovariance, Rotation, Time, TransformStamped, Transforms,
    Twist, Vector,
};
use std::collections::BTreeMap;
use std::io::{Cursor, Write};
use std::sync::Arc;

/// The begin of all bags, s since the epoch.
pub(super) const BEGIN_S: f64 = 1_700_000_000.0;

pub(super) const SCAN: &str = "sensor_msgs/msg/LaserScan";
pub(super) const ODOMETRY: &str = "nav_msgs/msg/Odometry";
pub(super) const TF: &str = "tf2_msgs/msg/TFMessage";

/// The messages of a bag: topic, type, time of recording in ns, data.
#[derive(Clone, Default)]
pub(super) struct Builder {
    pub(super) messages: Vec<(String, String, u64, Vec<u8>)>,
    pub(super) has_sums: bool,
    pub(super) encoding: Option<String>,
}

/// A header, `time_s` after the begin.
pub(super) fn header(time_s: f64, frame: &str) -> Header {
    let ns = ((BEGIN_S + time_s) * 1e3).round() as i64 * 1_000_000;
    let stamp = Time { sec: (ns / 1_000_000_000) as i32, nanosec: (ns % 1_000_000_000) as u32 };
    Header { stamp, frame_id: frame.to_owned() }
}

/// A pose in the plane.
pub(super) fn pose(x: f64, y: f64, heading_rad: f64) -> Pose {
    let (z, w) = ((heading_rad / 2.0).sin(), (heading_rad / 2.0).cos());
    Pose { position: Vector { x, y, z: 0.0 }, orientation: Rotation { x: 0.0, y: 0.0, z, w } }
}

/// Ahead, to the left, and behind.
pub(super) fn scan(time_s: f64, frame: &str) -> LaserScan {
    LaserScan {
        header: header(time_s, frame),
        angle_max: 3.0,
        angle_increment: 1.5,
        scan_time: 0.1,
        range_min: 0.1,
        range_max: 10.0,
        ranges: vec![1.0, 2.0, 3.0],
        ..LaserScan::default()
    }
}

pub(super) fn transform(time_s: f64, parent: &str, child: &str, transform: Pose) -> TransformStamped {
    TransformStamped { header: header(time_s, parent), child_frame_id: child.to_owned(), transform }
}

/// A transform without a distance.
pub(super) fn still(parent: &str, child: &str) -> TransformStamped {
    transform(0.0, parent, child, pose(0.0, 0.0, 0.0))
}

/// Times from 0 on, s.
pub(super) fn times(count: u32, period_s: f64) -> impl Iterator<Item = f64> {
    (0..count).map(move |step| f64::from(step) * period_s)
}

impl Builder {
    fn add(&mut self, topic: &str, type_name: &str, time_s: f64, data: Vec<u8>) -> &mut Self {
        let log_ns = ((BEGIN_S + time_s) * 1e9) as u64;
        self.messages.push((topic.to_owned(), type_name.to_owned(), log_ns, data));
        self
    }

    pub(super) fn scan(&mut self, topic: &str, time_s: f64, scan: &LaserScan) -> &mut Self {
        self.add(topic, SCAN, time_s, encoded(scan).unwrap())
    }

    pub(super) fn odometry(&mut self, topic: &str, time_s: f64, x: f64, heading_rad: f64) -> &mut Self {
        let odometry = Odometry {
            header: header(time_s, "odom"),
            child_frame_id: "base_link".to_owned(),
            pose: PoseWithCovariance { pose: pose(x, 0.0, heading_rad), covariance: Default::default() },
            twist: Twist::default(),
            twist_covariance: Default::default(),
        };
        self.add(topic, ODOMETRY, time_s, encoded(&odometry).unwrap())
    }

    pub(super) fn tf(&mut self, topic: &str, time_s: f64, transforms: &[TransformStamped]) -> &mut Self {
        let transforms = Transforms { transforms: transforms.to_vec() };
        self.add(topic, TF, time_s, encoded(&transforms).unwrap())
    }

    /// A laser 0.2 m ahead of the middle of a robot.
    pub(super) fn mount(&mut self) -> &mut Self {
        self.tf("/tf_static", 0.0, &[transform(0.0, "base_link", "laser", pose(0.2, 0.0, 0.0))])
    }

    /// An MCAP file, mostly without checksums, so that damage reaches our parser.
    pub(super) fn mcap(&self, options: WriteOptions) -> Vec<u8> {
        let mut writer = options
            .profile("ros2")
            .calculate_chunk_crcs(self.has_sums)
            .create(Cursor::new(Vec::new()))
            .expect("a writer to memory");
        let encoding = self.encoding.as_deref().unwrap_or("cdr");
        for (topic, type_name, log_time, data) in &self.messages {
            let schema = writer.add_schema(type_name, "ros2msg", b"").expect("a schema");
            let channel_id =
                writer.add_channel(schema, topic, encoding, &BTreeMap::new()).expect("a channel");
            let header =
                MessageHeader { channel_id, sequence: 0, log_time: *log_time, publish_time: *log_time };
            writer.write_to_known_channel(&header, data).expect("a message");
        }
        writer.finish().expect("an end");
        writer.into_inner().into_inner()
    }

    /// A database.
    pub(super) fn sqlite(&self) -> Vec<u8> {
        let file = tempfile::NamedTempFile::new().unwrap();
        let database = rusqlite::Connection::open(file.path()).unwrap();
        let tables = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, \
                      serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL); \
                      CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, \
                      timestamp INTEGER NOT NULL, data BLOB NOT NULL); \
                      CREATE INDEX timestamp_idx ON messages(timestamp ASC); BEGIN";
        database.execute_batch(tables).unwrap();
        let mut topics: Vec<&str> = Vec::new();
        for (topic, type_name, log_ns, data) in &self.messages {
            let known = topics.iter().position(|known| known == topic);
            let id = known.unwrap_or_else(|| {
                let row = (topics.len() as i64, topic, type_name, self.encoding.as_deref().unwrap_or("cdr"));
                database.execute("INSERT INTO topics VALUES (?1, ?2, ?3, ?4, '')", row).unwrap();
                topics.push(topic);
                topics.len() - 1
            });
            let row = (id as i64, *log_ns as i64, data);
            database.execute("INSERT INTO messages VALUES (NULL, ?1, ?2, ?3)", row).unwrap();
        }
        database.execute_batch("COMMIT").unwrap();
        drop(database);
        std::fs::read(file.path()).unwrap()
    }

    /// A scan of the usual laser.
    pub(super) fn laser(&mut self, time_s: f64) -> &mut Self {
        self.scan("/scan", time_s, &scan(time_s, "laser"))
    }

    /// The bag as a small MCAP file, opened.
    pub(super) fn log(&self) -> Log {
        read(&self.mcap(plain()))
    }

    /// The same with a choice.
    pub(super) fn open(&self, choice: &TopicChoice) -> Result<Log, LogError> {
        open(&self.mcap(plain()), choice)
    }

    /// Why the bag cannot be opened.
    pub(super) fn refused(&self) -> String {
        refused(&self.mcap(plain()))
    }
}

/// Without compression.
pub(super) fn plain() -> WriteOptions {
    WriteOptions::new().compression(None)
}

pub(super) fn compressed(by: Compression) -> WriteOptions {
    WriteOptions::new().compression(Some(by))
}

/// A bag of one file.
pub(super) fn open(bytes: &[u8], choice: &TopicChoice) -> Result<Log, LogError> {
    let io = |why| LogError::Io { file: "test".to_owned(), why };
    let bytes = if bytes.starts_with(b"SQLite") {
        let mut file = tempfile::NamedTempFile::new().map_err(io)?;
        file.write_all(bytes).map_err(io)?;
        Bytes::Unpacked(Arc::new(file))
    } else {
        Bytes::Memory(bytes.into())
    };
    let Some(file) = BagFile::recognized("test".into(), bytes).map_err(io)? else {
        return Err(LogError::Unusable { file: "test".to_owned(), why: "not a bag".to_owned() });
    };
    Bag::open("test", vec![file], choice, Vec::new())
}

/// A bag of one file that can be opened.
pub(super) fn read(bytes: &[u8]) -> Log {
    open(bytes, &TopicChoice::default()).unwrap()
}

/// Why a bag of one file cannot be opened.
pub(super) fn refused(bytes: &[u8]) -> String {
    open(bytes, &TopicChoice::default()).expect_err("the bag should be refused").to_string()
}

#[track_caller]
pub(super) fn assert_has(text: &str, parts: &[&str]) {
    parts.iter().for_each(|part| assert!(text.contains(part), "{part}: {text}"));
}

/// The notes of a bag, one per line.
pub(super) fn notes(bag: &Log) -> String {
    bag.summary().notes.join("\n")
}

pub(super) fn readings(bag: &Log) -> Vec<LaserReading> {
    bag.readings().unwrap().map(|reading| reading.expect("a reading that was surveyed")).collect()
}

//! Recordings as bags of ROS 2: MCAP files that Foxglove shows, and that `logs::Log` reads.

mod channels;
mod odometry;
mod schemas;
mod sorted;

use crate::messages::{
    Header, OccupancyGrid, Odometry, Path, PointCloud2, PointField, Pose, PoseStamped, Time,
    TransformStamped, Transforms,
};
use crate::scan::{FIRST_STAMP_NS, message as scan_message};
use channels::Channels;
use interfaces::{Event, Grid, LaserReading, Twist};
use nalgebra::{Isometry2, Point2};
use std::collections::BTreeMap;
use std::io::{Error, Write};

/// The frames, by REP-105.
const MAP: &str = "map";
const ODOM: &str = "odom";
const BASE: &str = "base_link";
const LASER: &str = "laser";
/// The type of a number of 32 bits in a point cloud.
const FLOAT32: u8 = 7;
/// The bytes of a point: x, y, z and the change.
const POINT_BYTES: u32 = 16;

/// Writes a run as a bag of ROS 2 in the format MCAP, with compressed chunks and an index.
///
/// | method | topics | messages |
/// |---|---|---|
/// | [`reading`](Self::reading) | `/scan`, `/odom`, `/tf`, `/tf_static` | `LaserScan`, `Odometry`, `TFMessage` |
/// | [`correction`](Self::correction) | `/tf` | `TFMessage`: odom in map |
/// | [`grid`](Self::grid) | the given one | `OccupancyGrid` |
/// | [`goal`](Self::goal), [`path`](Self::path) | `/goal_pose`, `/plan` | `PoseStamped`, `Path` |
/// | [`events`](Self::events) | `/changes` | `PointCloud2` with the field `change`: 1 blocked, −1 free |
///
/// Poses of a reading are given in the frame `odom`, all others in the frame `map`. Times are those of the readings, after
/// the begin that is given first.
///
/// The same run gives the same file, byte by byte.
///
/// A file that is not finished can be read up to its last chunk. For a file that appears when it is complete, give the writer
/// one with a temporary name, and rename it after [`finish`](Self::finish).
pub struct McapWriter<W: Write> {
    channels: Channels<W>,
    begin_ns: i64,
    /// Where the laser is on the robot, as last written.
    mount: Option<Isometry2<f64>>,
    map_to_odom: Isometry2<f64>,
    /// The last map of each topic.
    grids: BTreeMap<String, Grid<i8>>,
    /// The time (ns) and the pose of the last odometry.
    last_odometry: Option<(i64, Isometry2<f64>)>,
}

impl<W: Write> McapWriter<W> {
    /// Begins a recording. `name` is that of the file in messages; `begin_s` is the time 0 of the readings in seconds since
    /// the epoch, 0 in a simulation: its stamps begin at 10 s, so that none of a scan that begins before the time 0 is negative.
    ///
    /// # Errors
    ///
    /// When the file cannot be written, as for all methods.
    pub fn new(to: W, name: &str, begin_s: f64) -> Result<Self, Error> {
        Ok(Self {
            channels: Channels::new(to, name)?,
            begin_ns: (begin_s.floor() as i64)
                .saturating_mul(1_000_000_000)
                .saturating_add(((begin_s - begin_s.floor()) * 1e9).round() as i64)
                .max(FIRST_STAMP_NS),
            mount: None,
            map_to_odom: Isometry2::identity(),
            grids: BTreeMap::new(),
            last_odometry: None,
        })
    }

    /// Writes a reading: scan, odometry and transforms. A scan that sweeps comes with the odometry while it was measured.
    pub fn reading(&mut self, reading: &LaserReading) -> Result<(), Error> {
        let end_ns = self.ns(reading.time_s);
        self.laser(end_ns, &reading.mount)?;
        self.odometry(reading)?;
        let scan = scan_message(reading, LASER.to_owned(), end_ns);
        self.channels.write("/scan", "sensor_msgs/LaserScan", end_ns, &scan)
    }

    /// Writes a correction of the odometry: the pose of its frame in the frame of the map. It holds from now on.
    pub fn correction(&mut self, time_s: f64, map_to_odom: &Isometry2<f64>) -> Result<(), Error> {
        self.map_to_odom = *map_to_odom;
        let ns = self.ns(time_s);
        self.transforms("/tf", ns, &[(MAP, ODOM, *map_to_odom)])
    }

    /// Writes a map to `topic` if it differs from the last one there. `share` gives the value of a cell from 0 to 1, `None` if it is
    /// unknown.
    pub fn grid<T>(
        &mut self,
        topic: &str,
        time_s: f64,
        grid: &Grid<T>,
        share: impl Fn(&T) -> Option<f64>,
    ) -> Result<(), Error> {
        let ns = self.ns(time_s);
        let percent =
            |cell: &T| share(cell).map_or(-1, |share| (share.clamp(0.0, 1.0) * 100.0).round() as i8);
        let grid = grid.map(percent);
        if self.grids.get(topic) == Some(&grid) {
            return Ok(());
        }
        let message = OccupancyGrid::of(&grid, header(ns, MAP));
        self.grids.insert(topic.to_owned(), grid);
        self.channels.write(topic, "nav_msgs/OccupancyGrid", ns, &message)
    }

    /// Writes the pose to which the robot drives.
    pub fn goal(&mut self, time_s: f64, pose: &Isometry2<f64>) -> Result<(), Error> {
        let ns = self.ns(time_s);
        let goal = PoseStamped { header: header(ns, MAP), pose: Pose::in_plane(pose) };
        self.channels.write("/goal_pose", "geometry_msgs/PoseStamped", ns, &goal)
    }

    /// Writes the path on which it drives there; none if it is empty.
    pub fn path(&mut self, time_s: f64, poses: &[Isometry2<f64>]) -> Result<(), Error> {
        let ns = self.ns(time_s);
        let stamped = |pose| PoseStamped { header: header(ns, MAP), pose: Pose::in_plane(pose) };
        let path = Path { header: header(ns, MAP), poses: poses.iter().map(stamped).collect() };
        self.channels.write("/plan", "nav_msgs/Path", ns, &path)
    }

    /// Writes changes of the place, each with the center of its cell.
    pub fn events(&mut self, time_s: f64, events: &[(Point2<f64>, Event)]) -> Result<(), Error> {
        let ns = self.ns(time_s);
        let mut data = Vec::with_capacity(events.len() * POINT_BYTES as usize);
        for (center, event) in events {
            let change = match event {
                Event::Block => 1.0,
                Event::Free => -1.0,
            };
            for value in [center.x as f32, center.y as f32, 0.0, change] {
                data.extend(value.to_le_bytes());
            }
        }
        let field = |(index, name): (u32, &str)| PointField {
            name: name.to_owned(),
            offset: index * 4,
            datatype: FLOAT32,
            count: 1,
        };
        let cloud = PointCloud2 {
            header: header(ns, MAP),
            height: 1,
            width: events.len() as u32,
            fields: (0..).zip(["x", "y", "z", "change"]).map(field).collect(),
            is_bigendian: false,
            point_step: POINT_BYTES,
            row_step: data.len() as u32,
            data,
            is_dense: true,
        };
        self.channels.write("/changes", "sensor_msgs/PointCloud2", ns, &cloud)
    }

    /// Writes the index and ends the file.
    pub fn finish(self) -> Result<W, Error> {
        self.channels.finish()
    }

    fn ns(&self, time_s: f64) -> i64 {
        self.begin_ns.saturating_add((time_s * 1e9).round() as i64)
    }

    /// Writes where the laser is on the robot: a static transform at first, and a transform when it has moved. The scans of several
    /// lasers are those of one that moves.
    fn laser(&mut self, ns: i64, mount: &Isometry2<f64>) -> Result<(), Error> {
        match self.mount.replace(*mount) {
            None => self.transforms("/tf_static", ns, &[(BASE, LASER, *mount)]),
            Some(before) if before != *mount => self.transforms("/tf", ns, &[(BASE, LASER, *mount)]),
            Some(_) => Ok(()),
        }
    }

    /// The odometry at the end of a reading, and before it while the scan was measured.
    fn odometry(&mut self, reading: &LaserReading) -> Result<(), Error> {
        let last =
            self.last_odometry.map(|(ns, pose)| (ns.saturating_sub(self.begin_ns) as f64 * 1e-9, pose));
        for step in odometry::steps(reading, last) {
            let ns = self.ns(step.time_s);
            if self.last_odometry.is_none_or(|(last_ns, _)| last_ns < ns) {
                self.last_odometry = Some((ns, step.pose));
                self.pose(ns, &step.pose, &step.twist)?;
            }
        }
        Ok(())
    }

    fn pose(&mut self, ns: i64, pose: &Isometry2<f64>, twist: &Twist) -> Result<(), Error> {
        let odometry = Odometry::in_plane(header(ns, ODOM), BASE, pose, twist);
        self.channels.write("/odom", "nav_msgs/Odometry", ns, &odometry)?;
        self.transforms("/tf", ns, &[(MAP, ODOM, self.map_to_odom), (ODOM, BASE, *pose)])
    }

    fn transforms(
        &mut self,
        topic: &str,
        ns: i64,
        transforms: &[(&str, &str, Isometry2<f64>)],
    ) -> Result<(), Error> {
        let stamped = |(parent, child, pose): &(&str, &str, Isometry2<f64>)| TransformStamped {
            header: header(ns, parent),
            child_frame_id: (*child).to_owned(),
            transform: Pose::in_plane(pose),
        };
        let message = Transforms { transforms: transforms.iter().map(stamped).collect() };
        self.channels.write(topic, "tf2_msgs/TFMessage", ns, &message)
    }
}

fn header(ns: i64, frame: &str) -> Header {
    Header { stamp: Time::from_ns(ns), frame_id: frame.to_owned() }
}

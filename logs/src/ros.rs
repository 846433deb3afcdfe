//! The messages of ROS 2, as in `common_interfaces` and `geometry2`. Field by field, they are what CDR encodes.

use nalgebra::{Isometry2, Isometry3, Quaternion, Translation3, UnitQuaternion};
use serde::{Deserialize, Serialize};

/// A time of ROS.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub(crate) struct Time {
    pub(crate) sec: i32,
    pub(crate) nanosec: u32,
}

impl Time {
    /// The time from ns. What is before or after all times of ROS is the first or the last.
    pub(crate) fn from_ns(ns: i64) -> Self {
        let sec = ns.div_euclid(1_000_000_000).clamp(i32::MIN.into(), i32::MAX.into());
        Self { sec: sec as i32, nanosec: ns.rem_euclid(1_000_000_000) as u32 }
    }

    /// The time in ns.
    pub(crate) fn ns(self) -> i64 {
        i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec)
    }
}

/// `std_msgs/Header`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub(crate) struct Header {
    pub(crate) stamp: Time,
    pub(crate) frame_id: String,
}

/// `sensor_msgs/LaserScan`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct LaserScan {
    pub(crate) header: Header,
    pub(crate) angle_min: f32,
    pub(crate) angle_max: f32,
    pub(crate) angle_increment: f32,
    pub(crate) time_increment: f32,
    pub(crate) scan_time: f32,
    pub(crate) range_min: f32,
    pub(crate) range_max: f32,
    pub(crate) ranges: Vec<f32>,
    pub(crate) intensities: Vec<f32>,
}

/// `geometry_msgs/Point` and `Vector3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub(crate) struct Vector {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) z: f64,
}

/// `geometry_msgs/Quaternion`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Rotation {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) z: f64,
    pub(crate) w: f64,
}

/// `geometry_msgs/Pose` and `Transform`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Pose {
    pub(crate) position: Vector,
    pub(crate) orientation: Rotation,
}

impl Pose {
    /// A pose in the plane. The quaternion of half the angle follows from the sine and the cosine without an angle.
    pub(crate) fn in_plane(pose: &Isometry2<f64>) -> Self {
        let (cos, sin) = (pose.rotation.re, pose.rotation.im);
        let larger = ((1.0 + cos.abs()) / 2.0).sqrt();
        let smaller = sin.abs() / (2.0 * larger);
        let (z, w) = if cos > 0.0 { (smaller, larger) } else { (larger, smaller) };
        let orientation = Rotation { x: 0.0, y: 0.0, z: z.copysign(sin), w };
        Self { position: Vector { x: pose.translation.x, y: pose.translation.y, z: 0.0 }, orientation }
    }

    /// The pose; `None` if a number is not finite or far beyond all places, or the rotation is none.
    pub(crate) fn isometry(&self) -> Option<Isometry3<f64>> {
        let Self { position: Vector { x, y, z }, orientation } = *self;
        let rotation = Quaternion::new(orientation.w, orientation.x, orientation.y, orientation.z);
        let is_near = [x, y, z].iter().all(|at| at.abs() <= interfaces::FARTHEST_M);
        let is_rotation = (0.5..2.0).contains(&rotation.norm());
        (is_near && is_rotation).then(|| {
            Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_quaternion(rotation))
        })
    }
}

/// The covariance of 6 figures: 36 numbers.
pub(crate) type Covariance = ([f64; 18], [f64; 18]);

/// `geometry_msgs/PoseWithCovariance`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct PoseWithCovariance {
    pub(crate) pose: Pose,
    pub(crate) covariance: Covariance,
}

/// `geometry_msgs/TwistWithCovariance`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub(crate) struct TwistWithCovariance {
    pub(crate) linear: Vector,
    pub(crate) angular: Vector,
    pub(crate) covariance: Covariance,
}

/// `nav_msgs/Odometry`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Odometry {
    pub(crate) header: Header,
    pub(crate) child_frame_id: String,
    pub(crate) pose: PoseWithCovariance,
    pub(crate) twist: TwistWithCovariance,
}

/// `geometry_msgs/TransformStamped`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct TransformStamped {
    pub(crate) header: Header,
    pub(crate) child_frame_id: String,
    pub(crate) transform: Pose,
}

/// `tf2_msgs/TFMessage`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Transforms {
    pub(crate) transforms: Vec<TransformStamped>,
}

/// `geometry_msgs/PoseStamped`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct PoseStamped {
    pub(crate) header: Header,
    pub(crate) pose: Pose,
}

/// `nav_msgs/Path`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct Path {
    pub(crate) header: Header,
    pub(crate) poses: Vec<PoseStamped>,
}

/// `nav_msgs/OccupancyGrid`, with its `MapMetaData`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct OccupancyGrid {
    pub(crate) header: Header,
    pub(crate) map_load_time: Time,
    pub(crate) resolution: f32,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) origin: Pose,
    pub(crate) data: Vec<i8>,
}

/// `map_msgs/OccupancyGridUpdate`: a rectangle of cells.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct OccupancyGridUpdate {
    pub(crate) header: Header,
    pub(crate) x: i32,
    pub(crate) y: i32,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) data: Vec<i8>,
}

/// `sensor_msgs/PointField`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct PointField {
    pub(crate) name: String,
    pub(crate) offset: u32,
    pub(crate) datatype: u8,
    pub(crate) count: u32,
}

/// `sensor_msgs/PointCloud2`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(crate) struct PointCloud2 {
    pub(crate) header: Header,
    pub(crate) height: u32,
    pub(crate) width: u32,
    pub(crate) fields: Vec<PointField>,
    pub(crate) is_bigendian: bool,
    pub(crate) point_step: u32,
    pub(crate) row_step: u32,
    pub(crate) data: Vec<u8>,
    pub(crate) is_dense: bool,
}

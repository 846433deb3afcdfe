//! The messages. Field by field, they are what CDR encodes.
#![expect(missing_docs, reason = "the fields have the names, meanings and units of the definitions of ROS")]

use nalgebra::{Isometry2, Isometry3, Quaternion, Translation3, UnitQuaternion};
use serde::{Deserialize, Serialize};

/// A time of ROS.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Time {
    pub sec: i32,
    pub nanosec: u32,
}

impl Time {
    /// The time from ns. What is before or after all times of ROS is the first or the last.
    pub fn from_ns(ns: i64) -> Self {
        let sec = ns.div_euclid(1_000_000_000).clamp(i32::MIN.into(), i32::MAX.into());
        Self { sec: sec as i32, nanosec: ns.rem_euclid(1_000_000_000) as u32 }
    }

    /// The time in ns.
    pub fn ns(self) -> i64 {
        i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec)
    }
}

/// `std_msgs/Header`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Header {
    pub stamp: Time,
    pub frame_id: String,
}

/// `sensor_msgs/LaserScan`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct LaserScan {
    pub header: Header,
    pub angle_min: f32,
    pub angle_max: f32,
    pub angle_increment: f32,
    pub time_increment: f32,
    pub scan_time: f32,
    pub range_min: f32,
    pub range_max: f32,
    pub ranges: Vec<f32>,
    pub intensities: Vec<f32>,
}

/// `geometry_msgs/Point` and `Vector3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Vector {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

/// `geometry_msgs/Quaternion`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Rotation {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

/// `geometry_msgs/Pose` and `Transform`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Pose {
    pub position: Vector,
    pub orientation: Rotation,
}

impl Pose {
    /// A pose in the plane. The quaternion of half the angle follows from the sine and the cosine without an angle.
    pub fn in_plane(pose: &Isometry2<f64>) -> Self {
        let (cos, sin) = (pose.rotation.re, pose.rotation.im);
        let larger = ((1.0 + cos.abs()) / 2.0).sqrt();
        let smaller = sin.abs() / (2.0 * larger);
        let (z, w) = if cos > 0.0 { (smaller, larger) } else { (larger, smaller) };
        let orientation = Rotation { x: 0.0, y: 0.0, z: z.copysign(sin), w };
        Self { position: Vector { x: pose.translation.x, y: pose.translation.y, z: 0.0 }, orientation }
    }

    /// The pose; `None` if a number is not finite or far beyond all places, or the rotation is none.
    pub fn isometry(&self) -> Option<Isometry3<f64>> {
        let Self { position: Vector { x, y, z }, orientation } = *self;
        let rotation = Quaternion::new(orientation.w, orientation.x, orientation.y, orientation.z);
        let is_near = [x, y, z].iter().all(|at| at.abs() <= interfaces::FARTHEST_M);
        let is_rotation = (0.5..2.0).contains(&rotation.norm());
        (is_near && is_rotation).then(|| {
            Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_quaternion(rotation))
        })
    }
}

/// The covariance of x, y, z and the angles about them.
pub type Covariance = [[f64; 6]; 6];

/// `geometry_msgs/PoseWithCovariance`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct PoseWithCovariance {
    pub pose: Pose,
    pub covariance: Covariance,
}

/// `geometry_msgs/Twist`: m/s and rad/s, in the frame of the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Twist {
    pub linear: Vector,
    pub angular: Vector,
}

impl Twist {
    /// The velocity of a robot in the plane.
    pub fn in_plane(twist: &interfaces::Twist) -> Self {
        let linear = Vector { x: twist.linear_mps, ..Vector::default() };
        Self { linear, angular: Vector { z: twist.angular_radps, ..Vector::default() } }
    }
}

/// `nav_msgs/Odometry`, with its `TwistWithCovariance` as two fields.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Odometry {
    pub header: Header,
    pub child_frame_id: String,
    pub pose: PoseWithCovariance,
    pub twist: Twist,
    pub twist_covariance: Covariance,
}

impl Odometry {
    /// The pose and the velocity of a robot in the plane.
    pub fn in_plane(header: Header, robot: &str, pose: &Isometry2<f64>, twist: &interfaces::Twist) -> Self {
        Self {
            header,
            child_frame_id: robot.to_owned(),
            pose: PoseWithCovariance { pose: Pose::in_plane(pose), covariance: Default::default() },
            twist: Twist::in_plane(twist),
            twist_covariance: Default::default(),
        }
    }
}

/// `geometry_msgs/TransformStamped`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct TransformStamped {
    pub header: Header,
    pub child_frame_id: String,
    pub transform: Pose,
}

/// `tf2_msgs/TFMessage`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Transforms {
    pub transforms: Vec<TransformStamped>,
}

/// `geometry_msgs/PoseStamped`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct PoseStamped {
    pub header: Header,
    pub pose: Pose,
}

/// `nav_msgs/Path`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Path {
    pub header: Header,
    pub poses: Vec<PoseStamped>,
}

/// `nav_msgs/OccupancyGrid`, with its `MapMetaData`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct OccupancyGrid {
    pub header: Header,
    pub map_load_time: Time,
    pub resolution: f32,
    pub width: u32,
    pub height: u32,
    pub origin: Pose,
    pub data: Vec<i8>,
}

/// `map_msgs/OccupancyGridUpdate`: a rectangle of cells.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct OccupancyGridUpdate {
    pub header: Header,
    pub x: i32,
    pub y: i32,
    pub width: u32,
    pub height: u32,
    pub data: Vec<i8>,
}

/// `sensor_msgs/PointField`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct PointField {
    pub name: String,
    pub offset: u32,
    pub datatype: u8,
    pub count: u32,
}

/// `sensor_msgs/PointCloud2`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct PointCloud2 {
    pub header: Header,
    pub height: u32,
    pub width: u32,
    pub fields: Vec<PointField>,
    pub is_bigendian: bool,
    pub point_step: u32,
    pub row_step: u32,
    pub data: Vec<u8>,
    pub is_dense: bool,
}

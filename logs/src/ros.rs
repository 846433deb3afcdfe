//! The messages of ROS 2, as in `common_interfaces` and `geometry2`, and their encoding (CDR).

use byteorder::{BigEndian, LittleEndian};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use serde::{Deserialize, Serialize};

/// A time of ROS.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub(crate) struct Time {
    pub(crate) sec: i32,
    pub(crate) nanosec: u32,
}

impl Time {
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

/// A message from its bytes: two bytes name the order of the bytes, two are options.
///
/// # Errors
///
/// When the encoding is none of these, or the bytes end too early.
pub(crate) fn decoded<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Result<T, String> {
    let Some((start, body)) = bytes.split_at_checked(4) else {
        return Err(format!("{} bytes, too short for a message", bytes.len()));
    };
    let message = match start[..2] {
        [0, 0] => cdr_encoding::from_bytes::<T, BigEndian>(body),
        [0, 1] => cdr_encoding::from_bytes::<T, LittleEndian>(body),
        _ => return Err(format!("the encoding {:02x}{:02x} is not CDR", start[0], start[1])),
    };
    message.map(|(message, _)| message).map_err(|error| format!("it is damaged: {error}"))
}

/// A message as bytes, in little-endian order.
pub(crate) fn encoded<T: Serialize>(message: &T) -> Result<Vec<u8>, String> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend(cdr_encoding::to_vec::<T, LittleEndian>(message).map_err(|error| error.to_string())?);
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_orders_of_bytes_are_read() {
        let time = Time { sec: 1, nanosec: 2 };
        let little = [0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0];
        assert_eq!(encoded(&time).unwrap(), little);
        assert_eq!(decoded::<Time>(&little), Ok(time));
        assert_eq!(decoded::<Time>(&[0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2]), Ok(time));
        assert_eq!(decoded::<Time>(&[0, 7, 0, 0]).unwrap_err(), "the encoding 0007 is not CDR");
        // 2³² − 1 transforms in 4 bytes.
        let error = decoded::<Transforms>(&[0, 1, 0, 0, 255, 255, 255, 255]).unwrap_err();
        assert!(error.starts_with("it is damaged: "), "{error}");
    }
}

//! What ROS 2 exchanges, in files and live: messages, frames, and how they become values of ours.
//!
//! The messages are those of `common_interfaces`, `geometry2` and `navigation_msgs`.

mod frames;
mod grid;
mod messages;
mod scan;

pub use frames::{Chain, Frames, flat, mounted};
pub(crate) use frames::{can_be_base, is_base, is_odom, is_world};
pub use messages::{
    Covariance, Header, LaserScan, OccupancyGrid, OccupancyGridUpdate, Odometry, Path, PointCloud2,
    PointField, Pose, PoseStamped, PoseWithCovariance, Rotation, Time, TransformStamped, Transforms,
    TwistWithCovariance, Vector,
};
pub use scan::{FIRST_STAMP_NS, converted as scan_of, message as scan_message};

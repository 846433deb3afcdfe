//! What ROS 2 exchanges, in files and live: messages, their encoding, and how they become values of ours; and a writer of
//! bags. It must not know maps, readers of logs or the network.
//!
//! The messages are those of `common_interfaces`, `geometry2` and `navigation_msgs`.

pub mod cdr;
mod grid;
mod mcap;
mod messages;
mod scan;

pub use mcap::McapWriter;
pub use messages::{
    Covariance, Header, LaserScan, OccupancyGrid, OccupancyGridUpdate, Odometry, Path, PointCloud2,
    PointField, Pose, PoseStamped, PoseWithCovariance, Rotation, Time, TransformStamped, Transforms, Twist,
    Vector,
};
pub use scan::{FIRST_STAMP_NS, MAX_BEAMS, converted as scan_of, flat, message as scan_message, mounted};

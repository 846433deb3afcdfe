//! The messages that the nodes send and receive.

pub(crate) use crate::service::wire::ParameterEvent;
pub(crate) use crate::topic::{Quality, Topic};
pub(crate) use ros::{
    Header, LaserScan, OccupancyGrid, OccupancyGridUpdate, Odometry, Path, Pose, PoseStamped, Time,
    TransformStamped, Transforms, Twist,
};

use crate::service::wire::Transition;
use nalgebra::{Isometry2, Matrix3};
use ros::{Covariance, PoseWithCovariance};
use serde::{Deserialize, Serialize};

/// `geometry_msgs/TwistStamped`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct TwistStamped {
    /// The time of the command, and the frame of the robot.
    pub header: Header,
    /// The velocity.
    pub twist: Twist,
}

/// `nav2_msgs/CostmapFilterInfo`: what the values of a mask mean.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct CostmapFilterInfo {
    /// The time, and the frame of the mask.
    pub header: Header,
    /// What the filter does, one of the constants of this type.
    pub kind: u8,
    /// The topic of the mask.
    pub filter_mask_topic: String,
    /// The filter uses `base + multiplier × value`.
    pub base: f32,
    /// See [`base`](Self::base).
    pub multiplier: f32,
}

impl CostmapFilterInfo {
    /// The filter keeps out of cells.
    pub const KEEPOUT: u8 = 0;
    /// The filter limits the speed to a percentage.
    pub const SPEED_PERCENT: u8 = 1;
}

/// `geometry_msgs/PoseWithCovarianceStamped`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct PoseWithCovarianceStamped {
    /// The time, and the frame in which the pose is.
    pub header: Header,
    /// The pose, and the covariance of x, y, z (m²) and the angles about them (rad²).
    pub pose: PoseWithCovariance,
}

impl PoseWithCovarianceStamped {
    /// A pose in the plane with the covariance of x, y and heading.
    pub fn in_plane(header: Header, pose: &Isometry2<f64>, of_plane: &Matrix3<f64>) -> Self {
        let pose = PoseWithCovariance { pose: Pose::in_plane(pose), covariance: covariance(of_plane) };
        Self { header, pose }
    }
}

/// The places of x, y and the heading among x, y, z and the angles about them.
const PLACES: [usize; 3] = [0, 1, 5];

/// The covariance of x, y, z and the angles about them, from that of x, y and heading.
pub(crate) fn covariance(of_plane: &Matrix3<f64>) -> Covariance {
    let mut all = Covariance::default();
    for (row, at) in PLACES.into_iter().enumerate() {
        for (column, beside) in PLACES.into_iter().enumerate() {
            all[at][beside] = of_plane[(row, column)];
        }
    }
    all
}

/// The covariance of x, y and heading, from that of x, y, z and the angles about them.
pub(crate) fn of_plane(all: &Covariance) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| all[PLACES[row]][PLACES[column]])
}

/// `rcl_interfaces/Log`: a sentence for the log of all nodes.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Log {
    /// The time.
    pub stamp: Time,
    /// How bad it is, one of the constants of this type.
    pub level: u8,
    /// The name of the logger: that of the node.
    pub name: String,
    /// The sentence.
    pub msg: String,
    /// Where the program says it: the file, the function, the line. Not used.
    pub file: String,
    /// See [`file`](Self::file).
    pub function: String,
    /// See [`file`](Self::file).
    pub line: u32,
}

impl Log {
    /// Something that happens as it should.
    pub const INFO: u8 = 20;
    /// Something that a user should look at.
    pub const WARNING: u8 = 30;
}

/// The request of `nav2_msgs/DynamicEdges`, as in Kilted: numbers of edges have 16 bits.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct DynamicEdges {
    /// Edges that cannot be used.
    pub closed: Vec<u16>,
    /// Edges that can be used again.
    pub opened: Vec<u16>,
    /// Edges with what is added to their costs.
    pub adjusted: Vec<(u16, f32)>,
}

/// `lifecycle_msgs/TransitionEvent`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct TransitionEvent {
    /// The time, ns.
    pub timestamp: u64,
    /// The transition, with the states before and after it.
    pub transition: Transition,
}

/// `diagnostic_msgs/DiagnosticArray`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Diagnostics {
    /// The time.
    pub header: Header,
    /// One per part of the robot.
    pub status: Vec<DiagnosticStatus>,
}

/// `diagnostic_msgs/DiagnosticStatus`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct DiagnosticStatus {
    /// 0: as it should be, 1: warning, 2: error.
    pub level: u8,
    /// The part of the robot.
    pub name: String,
    /// One sentence.
    pub message: String,
    /// The device; empty for a program.
    pub hardware_id: String,
    /// Names and values.
    pub values: Vec<(String, String)>,
}

pub(crate) fn header(stamp: Time, frame: &str) -> Header {
    Header { stamp, frame_id: frame.to_owned() }
}

/// A message with the pose of a frame in another one.
pub(crate) fn transform(stamp: Time, (parent, child): (&str, &str), transform: Pose) -> Message {
    let header = header(stamp, parent);
    let transform = TransformStamped { header, child_frame_id: child.to_owned(), transform };
    Message::Transforms(Transforms { transforms: vec![transform] })
}

/// A message of any type. Only its content is written.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Message {
    /// A scan of a laser.
    Scan(LaserScan),
    /// A pose and a velocity by odometry.
    Odometry(Box<Odometry>),
    /// Transforms between frames.
    Transforms(Transforms),
    /// The time of a simulation, `rosgraph_msgs/Clock`.
    Clock(Time),
    /// A velocity.
    Twist(Twist),
    /// A velocity with a time.
    TwistStamped(TwistStamped),
    /// Yes or no, `std_msgs/Bool`.
    Bool(bool),
    /// A map.
    Grid(OccupancyGrid),
    /// A part of a map that has changed.
    GridUpdate(OccupancyGridUpdate),
    /// A path.
    Path(Path),
    /// A pose.
    Pose(PoseStamped),
    /// A pose with its covariance.
    PoseWithCovariance(Box<PoseWithCovarianceStamped>),
    /// What the values of a mask mean.
    FilterInfo(CostmapFilterInfo),
    /// How a node is.
    Diagnostics(Diagnostics),
    /// A sentence for the log.
    Log(Log),
    /// Parameters that have changed.
    ParameterEvent(ParameterEvent),
    /// A transition of the managed lifecycle.
    TransitionEvent(TransitionEvent),
}

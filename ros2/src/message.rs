//! What the nodes send and receive: messages, and the topics that carry them.

pub(crate) use logs::ros::{
    Header, LaserScan, OccupancyGrid, OccupancyGridUpdate, Odometry, Pose, PoseStamped, Time,
    TransformStamped, Transforms, Vector,
};

use serde::{Deserialize, Serialize};

/// `rosgraph_msgs/Clock`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Clock {
    /// The time of a simulation.
    pub clock: Time,
}

/// `geometry_msgs/Twist`: m/s and rad/s, in the frame of the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Twist {
    /// The linear velocity, m/s.
    pub linear: Vector,
    /// The angular velocity, rad/s.
    pub angular: Vector,
}

/// `geometry_msgs/TwistStamped`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct TwistStamped {
    /// The time of the command, and the frame of the robot.
    pub header: Header,
    /// The velocity.
    pub twist: Twist,
}

/// `std_msgs/Bool`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Bool {
    /// The value.
    pub data: bool,
}

/// `std_msgs/ColorRGBA`, each from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Color {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
    /// Opacity.
    pub a: f32,
}

/// `visualization_msgs/Marker`, as in Humble and later. The shapes of this project need no texture, text or mesh.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Marker {
    /// The time, and the frame of all points.
    pub header: Header,
    /// The group of the marker.
    pub ns: String,
    /// The number of the marker in its group: a later marker with the same number replaces it.
    pub id: i32,
    /// The shape, one of the constants of this type.
    pub shape: i32,
    /// What to do, one of the constants of this type.
    pub action: i32,
    /// The pose of the shape.
    pub pose: Pose,
    /// The size of the shape, m.
    pub scale: Vector,
    /// The color of the shape.
    pub color: Color,
    /// How long the marker is shown, s and ns; 0: until it is replaced.
    pub lifetime: (i32, u32),
    /// Whether the marker moves along with its frame.
    pub frame_locked: bool,
    /// The points of a line.
    pub points: Vec<Vector>,
    /// The colors of the points.
    pub colors: Vec<Color>,
    /// A texture.
    pub texture: Texture,
    /// A text.
    pub text: String,
    /// A mesh: its name, a file (name, bytes), and whether the materials of the file are used.
    pub mesh: (String, (String, Vec<u8>), bool),
}

/// The texture of a [`Marker`]: its name, the picture (header, format, bytes), and the coordinates of the points in it.
pub type Texture = (String, (Header, String, Vec<u8>), Vec<(f32, f32)>);

impl Marker {
    /// The shape of an arrow.
    pub const ARROW: i32 = 0;
    /// The shape of a line through the points.
    pub const LINE_STRIP: i32 = 4;
    /// Shows the marker.
    pub const ADD: i32 = 0;
    /// Removes the marker.
    pub const DELETE: i32 = 2;
}

/// `visualization_msgs/MarkerArray`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Markers {
    /// The markers.
    pub markers: Vec<Marker>,
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

/// A message of any type.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// A scan of a laser.
    Scan(LaserScan),
    /// A pose and a velocity by odometry.
    Odometry(Box<Odometry>),
    /// Transforms between frames.
    Transforms(Transforms),
    /// The time of a simulation.
    Clock(Clock),
    /// A velocity.
    Twist(Twist),
    /// A velocity with a time.
    TwistStamped(TwistStamped),
    /// Yes or no.
    Bool(Bool),
    /// A map.
    Grid(OccupancyGrid),
    /// A part of a map that has changed.
    GridUpdate(OccupancyGridUpdate),
    /// Shapes to be drawn.
    Markers(Markers),
    /// A pose.
    Pose(PoseStamped),
}

/// What a topic is for. Its name is a setting of the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Topic {
    /// The scans of the laser.
    Scan,
    /// The odometry.
    Odometry,
    /// Transforms that change.
    Transforms,
    /// Transforms that never change.
    StaticTransforms,
    /// The time of a simulation.
    Clock,
    /// Velocities for the robot, without a time.
    Velocity,
    /// Velocities for the robot, with a time. Its name is the same as that of [`Topic::Velocity`].
    StampedVelocity,
    /// Whether the robot explores, or waits.
    Resume,
    /// The map.
    Map,
    /// The parts of the map that changed since it was sent as a whole.
    MapUpdates,
    /// Where the place changes.
    ChangeMap,
    /// Where the place is probably blocked now.
    PredictedMap,
    /// The goal and the path of the robot, to be drawn.
    Markers,
    /// The pose to which Nav2 drives.
    GoalPose,
    /// The true pose of a simulated robot.
    GroundTruth,
}

/// How messages are delivered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quality {
    /// Whether lost messages are sent again.
    pub is_reliable: bool,
    /// Whether a later subscriber gets the last messages ("transient local").
    pub is_latched: bool,
    /// The number of messages that are kept.
    pub depth: usize,
}

impl Quality {
    /// The sensor-data profile of ROS.
    pub const SENSOR: Self = Self { is_reliable: false, is_latched: false, depth: 5 };
    /// The default profile of ROS.
    pub const DEFAULT: Self = Self { is_reliable: true, is_latched: false, depth: 10 };
    /// The profile of maps.
    pub const LATCHED: Self = Self { is_reliable: true, is_latched: true, depth: 1 };
}

impl Topic {
    /// The name that other nodes expect, relative to the namespace of the node, except for those that are absolute.
    pub fn default_name(self) -> &'static str {
        self.row().0
    }

    /// The type of its messages: a package and a name.
    pub fn type_name(self) -> (&'static str, &'static str) {
        (self.row().1, self.row().2)
    }

    /// How its messages are delivered, as subscribers and publishers of ROS expect it.
    pub fn quality(self) -> Quality {
        self.row().3
    }

    #[rustfmt::skip]
    fn row(self) -> (&'static str, &'static str, &'static str, Quality) {
        const DEFAULT: Quality = Quality::DEFAULT;
        const LATCHED: Quality = Quality::LATCHED;
        match self {
            Self::Scan => ("scan", "sensor_msgs", "LaserScan", Quality::SENSOR),
            Self::Odometry => ("odom", "nav_msgs", "Odometry", DEFAULT),
            Self::Transforms => ("/tf", "tf2_msgs", "TFMessage", Quality { depth: 100, ..DEFAULT }),
            Self::StaticTransforms => ("/tf_static", "tf2_msgs", "TFMessage", Quality { depth: 100, ..LATCHED }),
            Self::Clock => ("/clock", "rosgraph_msgs", "Clock", Quality { is_reliable: false, ..DEFAULT }),
            Self::Velocity => ("cmd_vel", "geometry_msgs", "Twist", DEFAULT),
            Self::StampedVelocity => ("cmd_vel", "geometry_msgs", "TwistStamped", DEFAULT),
            Self::Resume => ("explore/resume", "std_msgs", "Bool", DEFAULT),
            Self::Map => ("map", "nav_msgs", "OccupancyGrid", LATCHED),
            Self::MapUpdates => ("map_updates", "map_msgs", "OccupancyGridUpdate", DEFAULT),
            Self::ChangeMap => ("change_map", "nav_msgs", "OccupancyGrid", LATCHED),
            Self::PredictedMap => ("predicted_map", "nav_msgs", "OccupancyGrid", LATCHED),
            Self::Markers => ("explore/goals", "visualization_msgs", "MarkerArray", DEFAULT),
            Self::GoalPose => ("goal_pose", "geometry_msgs", "PoseStamped", DEFAULT),
            Self::GroundTruth => ("ground_truth", "nav_msgs", "Odometry", DEFAULT),
        }
    }
}

//! What a topic is for, and how its messages are delivered.

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
    /// Where the place is probably blocked, at the horizon of the node.
    PredictedMap,
    /// How often the place changes.
    RateMap,
    /// For how long a look is worth more than what is usual.
    ExpiryMap,
    /// Where Nav2 should drive slowly.
    SpeedMask,
    /// Where Nav2 should not drive.
    KeepoutMask,
    /// What the values of the speed mask mean.
    SpeedFilterInfo,
    /// What the values of the keepout mask mean.
    KeepoutFilterInfo,
    /// The pose of the robot in the map, with its covariance.
    EstimatedPose,
    /// Where the robot is, as a person says.
    InitialPose,
    /// How the node is.
    Diagnostics,
    /// What the node says.
    Log,
    /// Parameters that have changed.
    ParameterEvents,
    /// Transitions of the managed lifecycle.
    TransitionEvents,
    /// The path of the robot to its goal.
    Path,
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
    /// The profile of the log of all nodes.
    pub const LOG: Self = Self { is_reliable: true, is_latched: true, depth: 1000 };
}

/// Every topic in the order of the enum: the name that other nodes expect, relative to the namespace of the node, except for those
/// that are absolute; the type of its messages, a package and a name; how they are delivered, as subscribers and publishers of ROS
/// expect it; whether the mapping node subscribes (in) or publishes (out) it.
#[rustfmt::skip]
const TOPICS: [(Topic, &str, &str, &str, Quality, &str); 27] = [
    (Topic::Scan, "scan", "sensor_msgs", "LaserScan", Quality::SENSOR, "in"),
    (Topic::Odometry, "odom", "nav_msgs", "Odometry", DEFAULT, "in"),
    (Topic::Transforms, "/tf", "tf2_msgs", "TFMessage", Quality { depth: 100, ..DEFAULT }, "in, out"),
    (Topic::StaticTransforms, "/tf_static", "tf2_msgs", "TFMessage", Quality { depth: 100, ..LATCHED }, "in"),
    (Topic::Clock, "/clock", "rosgraph_msgs", "Clock", Quality { is_reliable: false, ..DEFAULT }, ""),
    (Topic::Velocity, "cmd_vel", "geometry_msgs", "Twist", DEFAULT, "out"),
    (Topic::StampedVelocity, "cmd_vel", "geometry_msgs", "TwistStamped", DEFAULT, "out"),
    (Topic::Resume, "explore/resume", "std_msgs", "Bool", DEFAULT, "in"),
    (Topic::Map, "map", "nav_msgs", "OccupancyGrid", LATCHED, "out"),
    (Topic::MapUpdates, "map_updates", "map_msgs", "OccupancyGridUpdate", DEFAULT, "out"),
    (Topic::ChangeMap, "change_map", "nav_msgs", "OccupancyGrid", LATCHED, "out"),
    (Topic::PredictedMap, "predicted_map", "nav_msgs", "OccupancyGrid", LATCHED, "out"),
    (Topic::RateMap, "rate_map", "nav_msgs", "OccupancyGrid", LATCHED, "out"),
    (Topic::ExpiryMap, "expiry_map", "nav_msgs", "OccupancyGrid", LATCHED, "out"),
    (Topic::SpeedMask, "speed_mask", "nav_msgs", "OccupancyGrid", LATCHED, "out"),
    (Topic::KeepoutMask, "keepout_mask", "nav_msgs", "OccupancyGrid", LATCHED, "out"),
    (Topic::SpeedFilterInfo, "speed_filter_info", "nav2_msgs", "CostmapFilterInfo", LATCHED, "out"),
    (Topic::KeepoutFilterInfo, "keepout_filter_info", "nav2_msgs", "CostmapFilterInfo", LATCHED, "out"),
    (Topic::EstimatedPose, "pose", "geometry_msgs", "PoseWithCovarianceStamped", DEFAULT, "out"),
    (Topic::InitialPose, "initialpose", "geometry_msgs", "PoseWithCovarianceStamped", DEFAULT, "in"),
    (Topic::Diagnostics, "/diagnostics", "diagnostic_msgs", "DiagnosticArray", DEFAULT, "out"),
    (Topic::Log, "/rosout", "rcl_interfaces", "Log", Quality::LOG, "out"),
    (Topic::ParameterEvents, "/parameter_events", "rcl_interfaces", "ParameterEvent", Quality { depth: 1000, ..DEFAULT }, "out"),
    (Topic::TransitionEvents, "~/transition_event", "lifecycle_msgs", "TransitionEvent", DEFAULT, "out"),
    (Topic::Path, "explore/path", "nav_msgs", "Path", DEFAULT, "out"),
    (Topic::GoalPose, "goal_pose", "geometry_msgs", "PoseStamped", DEFAULT, "out"),
    (Topic::GroundTruth, "ground_truth", "nav_msgs", "Odometry", DEFAULT, ""),
];

const DEFAULT: Quality = Quality::DEFAULT;
const LATCHED: Quality = Quality::LATCHED;

impl Topic {
    /// All topics.
    pub fn all() -> impl Iterator<Item = Self> {
        TOPICS.iter().map(|(topic, ..)| *topic)
    }

    /// The name that other nodes expect.
    pub fn default_name(self) -> &'static str {
        TOPICS[self as usize].1
    }

    /// The type of its messages: a package and a name.
    pub fn type_name(self) -> (&'static str, &'static str) {
        let (_, _, package, kind, ..) = TOPICS[self as usize];
        (package, kind)
    }

    /// How its messages are delivered.
    pub fn quality(self) -> Quality {
        TOPICS[self as usize].4
    }

    /// Whether the mapping node subscribes (`in`) or publishes (`out`) it.
    pub fn direction(self) -> &'static str {
        TOPICS[self as usize].5
    }
}

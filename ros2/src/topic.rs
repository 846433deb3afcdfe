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
            Self::RateMap => ("rate_map", "nav_msgs", "OccupancyGrid", LATCHED),
            Self::ExpiryMap => ("expiry_map", "nav_msgs", "OccupancyGrid", LATCHED),
            Self::SpeedMask => ("speed_mask", "nav_msgs", "OccupancyGrid", LATCHED),
            Self::KeepoutMask => ("keepout_mask", "nav_msgs", "OccupancyGrid", LATCHED),
            Self::SpeedFilterInfo => ("speed_filter_info", "nav2_msgs", "CostmapFilterInfo", LATCHED),
            Self::KeepoutFilterInfo => ("keepout_filter_info", "nav2_msgs", "CostmapFilterInfo", LATCHED),
            Self::EstimatedPose => ("pose", "geometry_msgs", "PoseWithCovarianceStamped", DEFAULT),
            Self::Diagnostics => ("/diagnostics", "diagnostic_msgs", "DiagnosticArray", DEFAULT),
            Self::InitialPose => ("initialpose", "geometry_msgs", "PoseWithCovarianceStamped", DEFAULT),
            Self::Log => ("/rosout", "rcl_interfaces", "Log", Quality::LOG),
            Self::ParameterEvents => ("/parameter_events", "rcl_interfaces", "ParameterEvent", Quality { depth: 1000, ..DEFAULT }),
            Self::TransitionEvents => ("~/transition_event", "lifecycle_msgs", "TransitionEvent", DEFAULT),
            Self::Path => ("explore/path", "nav_msgs", "Path", DEFAULT),
            Self::GoalPose => ("goal_pose", "geometry_msgs", "PoseStamped", DEFAULT),
            Self::GroundTruth => ("ground_truth", "nav_msgs", "Odometry", DEFAULT),
        }
    }
}

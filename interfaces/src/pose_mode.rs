/// How the pose of the robot is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PoseMode {
    /// The poses of the source are exact: odometry without any error, or a laser that does not move.
    Exact,
    /// The poses of the odometry, as they drift.
    Odometry,
    /// The pose that fits the scans.
    #[default]
    Localized,
    /// The poses of another SLAM that a log contains.
    Corrected,
}

impl PoseMode {
    /// All modes.
    pub const ALL: [Self; 4] = [Self::Exact, Self::Odometry, Self::Localized, Self::Corrected];
    /// The modes of a robot that is simulated or live.
    pub const LIVE: [Self; 3] = [Self::Exact, Self::Odometry, Self::Localized];

    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Odometry => "odometry",
            Self::Localized => "localized",
            Self::Corrected => "corrected",
        }
    }

    /// Whether the poses of a whole log fit to each other: then another log finds its place among its scans.
    pub fn is_consistent(self) -> bool {
        matches!(self, Self::Localized | Self::Corrected)
    }

    /// The mode with a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|mode| mode.name() == name)
    }
}

//! Parameters that are one of a few names.

use interfaces::PoseMode;
use mapper::NoReturn;

/// What the node does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// It maps, and gives no command.
    #[default]
    Map,
    /// It explores.
    Explore,
}

/// What drives the robot to goals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Navigator {
    /// The controller of this project, by velocities.
    #[default]
    CmdVel,
    /// Nav2, by its action NavigateToPose.
    Nav2,
    /// Whatever listens to the topic `goal_pose`.
    GoalPose,
}

impl Choice for NoReturn {
    const EXPECTED: &'static str = "learn, free or ignore";
    const ALL: &'static [(Self, &'static [&'static str])] =
        &[(Self::Learn, &["learn"]), (Self::Free, &["free"]), (Self::Ignore, &["ignore"])];
}

/// A value with a name.
pub(super) trait Choice: Copy + PartialEq + 'static {
    /// The names, as an error lists them.
    const EXPECTED: &'static str;
    /// Every value with its names, the first of which is the usual one.
    const ALL: &'static [(Self, &'static [&'static str])];

    fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, names)| names.contains(&name)).map(|(value, _)| *value)
    }

    fn name(self) -> &'static str {
        Self::ALL.iter().find(|(value, _)| *value == self).map_or("", |(_, names)| names[0])
    }
}

impl Choice for Mode {
    const EXPECTED: &'static str = "map or explore";
    // `slam_toolbox` calls it `mapping`.
    const ALL: &'static [(Self, &'static [&'static str])] =
        &[(Self::Map, &["map", "mapping"]), (Self::Explore, &["explore"])];
}

impl Choice for Navigator {
    const EXPECTED: &'static str = "cmd_vel, nav2 or goal_pose";
    const ALL: &'static [(Self, &'static [&'static str])] =
        &[(Self::CmdVel, &["cmd_vel"]), (Self::Nav2, &["nav2"]), (Self::GoalPose, &["goal_pose"])];
}

impl Choice for PoseMode {
    const EXPECTED: &'static str = "exact, odometry or localized";
    const ALL: &'static [(Self, &'static [&'static str])] =
        &[(Self::Exact, &["exact"]), (Self::Odometry, &["odometry"]), (Self::Localized, &["localized"])];
}

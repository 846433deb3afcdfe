//! The types of parameters.

use crate::value::Value;
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

/// When a parameter can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum When {
    /// At any time.
    Always,
    /// While the node is unconfigured: the map, the localization or the controller depend on it.
    Unconfigured,
    /// Before the node starts: its topics and services depend on it.
    Start,
}

/// A value with a name.
trait Choice: Copy + PartialEq + 'static {
    /// The names, as an error lists them.
    const EXPECTED: &'static str;
    /// Every value with its names, the first of which is the usual one.
    const ALL: &'static [(Self, &'static [&'static str])];
}

/// Where the value of a parameter is.
pub(super) trait Slot {
    /// # Errors
    ///
    /// The valid values.
    fn set(&mut self, value: &Value) -> Result<(), &'static str>;

    fn get(&self) -> Value;
}

impl<C: Choice> Slot for C {
    fn set(&mut self, value: &Value) -> Result<(), &'static str> {
        let is_named =
            |(_, names): &&(C, &[&str])| matches!(value, Value::Text(name) if names.contains(&&**name));
        *self = Self::ALL.iter().find(is_named).ok_or(C::EXPECTED)?.0;
        Ok(())
    }

    fn get(&self) -> Value {
        let own = Self::ALL.iter().find(|(value, _)| value == self);
        Value::Text(own.map_or("", |(_, names)| names[0]).to_owned())
    }
}

macro_rules! slot {
    ($kind:ty, $variant:ident, $expected:literal, { $($from:pat => $to:expr),+ }) => {
        impl Slot for $kind {
            fn set(&mut self, value: &Value) -> Result<(), &'static str> {
                *self = match value {
                    $($from => $to,)+
                    _ => return Err($expected),
                };
                Ok(())
            }

            fn get(&self) -> Value {
                Value::$variant(self.clone())
            }
        }
    };
}

slot!(String, Text, "a text", { Value::Text(text) => text.clone() });
slot!(f64, Float, "a number", { Value::Float(number) => *number, Value::Integer(number) => *number as f64 });
slot!(i64, Integer, "a whole number", { Value::Integer(number) => *number });
slot!(bool, Bool, "true or false", { Value::Bool(value) => *value });

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

impl Choice for NoReturn {
    const EXPECTED: &'static str = "learn, free or ignore";
    const ALL: &'static [(Self, &'static [&'static str])] =
        &[(Self::Learn, &["learn"]), (Self::Free, &["free"]), (Self::Ignore, &["ignore"])];
}

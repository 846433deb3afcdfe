//! The types of parameters.

use crate::value::Value;
use interfaces::PoseMode;
use mapper::NoReturn;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// What the node does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// It maps, and gives no command; `slam_toolbox` calls it `mapping`.
    #[default]
    #[serde(alias = "mapping")]
    Map,
    /// It explores.
    Explore,
}

/// What drives the robot to goals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
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

/// The type of a parameter.
trait Kind: DeserializeOwned + Serialize {
    /// The valid values, as an error lists them.
    const EXPECTED: &'static str;
}

macro_rules! kinds {
    ($($kind:ty = $expected:literal;)*) => {
        $(impl Kind for $kind {
            const EXPECTED: &'static str = $expected;
        })*
    };
}

kinds! {
    String = "a text";
    f64 = "a number";
    i64 = "a whole number";
    bool = "true or false";
    Mode = "map or explore";
    Navigator = "cmd_vel, nav2 or goal_pose";
    PoseMode = "exact, odometry or localized";
    NoReturn = "learn, free or ignore";
}

/// Where the value of a parameter is.
pub(super) trait Slot {
    /// # Errors
    ///
    /// The valid values.
    fn set(&mut self, value: &Value) -> Result<(), &'static str>;

    fn get(&self) -> Value;
}

impl<K: Kind> Slot for K {
    fn set(&mut self, value: &Value) -> Result<(), &'static str> {
        let found = serde_json::to_value(value).and_then(serde_json::from_value);
        *self = found.map_err(|_| K::EXPECTED)?;
        Ok(())
    }

    fn get(&self) -> Value {
        // A number that is not finite has no value: no parameter can have it.
        let value = serde_json::to_value(self).and_then(serde_json::from_value);
        value.unwrap_or(Value::Float(f64::NAN))
    }
}

//! The fields of requests and answers, in the order of their definitions in ROS: `std_srvs`, `slam_toolbox`, `lifecycle_msgs` and
//! `rcl_interfaces`.

use crate::message::Pose;
use crate::value::Value;
use serde::{Deserialize as De, Serialize as Se};

/// A message without a field has this one on the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, De, Se)]
pub(crate) struct Nothing {
    structure_needs_at_least_one_member: u8,
}

/// The answer of `std_srvs/Trigger`.
#[derive(Clone, Debug, PartialEq, Eq, De, Se)]
pub struct Trigger {
    /// Whether it is done.
    pub is_done: bool,
    /// One sentence.
    pub text: String,
}

/// The request of `slam_toolbox/DeserializePoseGraph`.
#[derive(Clone, Debug, PartialEq, De, Se)]
pub struct Deserialize {
    /// The file.
    pub filename: String,
    /// Where the robot is: one of the constants of this type.
    pub match_type: i8,
    /// The pose of the robot in the map.
    pub initial_pose: Pose,
}

impl Deserialize {
    /// The robot is where the map began.
    pub const START_AT_FIRST_NODE: i8 = 1;
    /// The robot is at the pose, and the map grows.
    pub const START_AT_GIVEN_POSE: i8 = 2;
    /// The robot is at the pose, and the map stays in `slam_toolbox`; here it learns on.
    pub const LOCALIZE_AT_POSE: i8 = 3;
}

/// `lifecycle_msgs/State` and `lifecycle_msgs/Transition`.
#[derive(Clone, Debug, PartialEq, Eq, De, Se)]
pub struct Labelled {
    /// The number.
    pub id: u8,
    /// The name.
    pub label: String,
}

/// `lifecycle_msgs/TransitionDescription`.
#[derive(Clone, Debug, PartialEq, Eq, De, Se)]
pub struct Transition {
    /// The transition.
    pub transition: Labelled,
    /// The state before it.
    pub start_state: Labelled,
    /// The state after it.
    pub goal_state: Labelled,
}

/// The request of `rcl_interfaces/ListParameters`.
#[derive(Clone, Debug, PartialEq, Eq, De, Se)]
pub struct Prefixes {
    /// Parameters below these; empty: all.
    pub prefixes: Vec<String>,
    /// The number of levels; 0: all.
    pub depth: u64,
}

/// `rcl_interfaces/ListParametersResult`.
#[derive(Clone, Debug, Default, PartialEq, Eq, De, Se)]
pub struct Listed {
    /// The names.
    pub names: Vec<String>,
    /// What stands before their last dots.
    pub prefixes: Vec<String>,
}

/// `rcl_interfaces/Parameter`.
#[derive(Clone, Debug, PartialEq, De, Se)]
pub struct Parameter {
    /// The name.
    pub name: String,
    /// The value.
    pub value: ParameterValue,
}

/// `rcl_interfaces/ParameterValue`: the type, and a field for each type.
#[derive(Clone, Debug, Default, PartialEq, De, Se)]
pub struct ParameterValue {
    /// The number of its type.
    pub kind: u8,
    boolean: bool,
    integer: i64,
    float: f64,
    text: String,
    bytes: Vec<u8>,
    booleans: Vec<bool>,
    integers: Vec<i64>,
    floats: Vec<f64>,
    texts: Vec<String>,
}

impl ParameterValue {
    /// The value; `None`: a list, or nothing.
    pub fn value(&self) -> Option<Value> {
        match self.kind {
            1 => Some(Value::Bool(self.boolean)),
            2 => Some(Value::Integer(self.integer)),
            3 => Some(Value::Float(self.float)),
            4 => Some(Value::Text(self.text.clone())),
            _ => None,
        }
    }
}

impl From<&Value> for ParameterValue {
    fn from(value: &Value) -> Self {
        match value.clone() {
            Value::Bool(boolean) => Self { kind: 1, boolean, ..Self::default() },
            Value::Integer(integer) => Self { kind: 2, integer, ..Self::default() },
            Value::Float(float) => Self { kind: 3, float, ..Self::default() },
            Value::Text(text) => Self { kind: 4, text, ..Self::default() },
        }
    }
}

/// `rcl_interfaces/SetParametersResult`.
#[derive(Clone, Debug, Default, PartialEq, Eq, De, Se)]
pub struct SetResult {
    /// Whether the parameter has the new value.
    pub successful: bool,
    /// Why not, in one sentence.
    pub reason: String,
}

/// `rcl_interfaces/ParameterDescriptor`.
#[derive(Clone, Debug, Default, PartialEq, De, Se)]
pub struct Description {
    /// The name.
    pub name: String,
    /// The type of its value.
    pub kind: u8,
    /// What it means.
    pub description: String,
    /// When it can be set.
    pub additional_constraints: String,
    /// Whether it cannot be set while the node runs.
    pub read_only: bool,
    /// Whether its type can change.
    pub dynamic_typing: bool,
    /// Not used: the ranges are checked, and refused with a sentence.
    pub floating_point_range: Vec<(f64, f64, f64)>,
    /// See [`floating_point_range`](Self::floating_point_range).
    pub integer_range: Vec<(i64, i64, u64)>,
}

/// `rcl_interfaces/ParameterEvent`.
#[derive(Clone, Debug, PartialEq, De, Se)]
pub struct ParameterEvent {
    /// The time.
    pub stamp: crate::message::Time,
    /// The full name of the node.
    pub node: String,
    /// Parameters that are new.
    pub new: Vec<Parameter>,
    /// Parameters that have another value.
    pub changed: Vec<Parameter>,
    /// Parameters that are gone.
    pub deleted: Vec<Parameter>,
}

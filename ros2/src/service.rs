//! The services that a node offers: their names, what they are asked, and what they answer.

pub(crate) mod wire;

use wire::{
    Description, Deserialize, Labelled, Listed, Parameter, ParameterValue, Prefixes, SetResult, Transition,
    Trigger,
};

/// What a service is for. Its name is a setting of the node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Service {
    /// Saves the state to the file of the node.
    SaveState,
    /// Writes the map as an image, as `slam_toolbox` does.
    SaveMap,
    /// Writes the state to any file, as `slam_toolbox` does with its graph.
    SerializeMap,
    /// Goes on from a state in any file.
    DeserializeMap,
    /// How long to wait at edges of the graph of routes that are probably blocked.
    GetPatience,
    /// A transition of the managed lifecycle.
    ChangeState,
    /// The state of the managed lifecycle.
    GetState,
    /// The states of the managed lifecycle.
    GetAvailableStates,
    /// The transitions from the present state.
    GetAvailableTransitions,
    /// All transitions.
    GetTransitionGraph,
    /// Values of parameters.
    GetParameters,
    /// Types of parameters.
    GetParameterTypes,
    /// Sets parameters, each for itself.
    SetParameters,
    /// Sets all parameters or none.
    SetParametersAtomically,
    /// Names of parameters.
    ListParameters,
    /// Descriptions of parameters.
    DescribeParameters,
}

/// Every service in the order of the enum: its name below that of the node, and its type, a package and a name.
#[rustfmt::skip]
const SERVICES: [(Service, &str, &str, &str); 16] = [
    (Service::SaveState, "~/save_state", "std_srvs", "Trigger"),
    (Service::SaveMap, "~/save_map", "slam_toolbox", "SaveMap"),
    (Service::SerializeMap, "~/serialize_map", "slam_toolbox", "SerializePoseGraph"),
    (Service::DeserializeMap, "~/deserialize_map", "slam_toolbox", "DeserializePoseGraph"),
    (Service::GetPatience, "~/get_patience", "std_srvs", "Trigger"),
    (Service::ChangeState, "~/change_state", "lifecycle_msgs", "ChangeState"),
    (Service::GetState, "~/get_state", "lifecycle_msgs", "GetState"),
    (Service::GetAvailableStates, "~/get_available_states", "lifecycle_msgs", "GetAvailableStates"),
    (Service::GetAvailableTransitions, "~/get_available_transitions", "lifecycle_msgs", "GetAvailableTransitions"),
    (Service::GetTransitionGraph, "~/get_transition_graph", "lifecycle_msgs", "GetAvailableTransitions"),
    (Service::GetParameters, "~/get_parameters", "rcl_interfaces", "GetParameters"),
    (Service::GetParameterTypes, "~/get_parameter_types", "rcl_interfaces", "GetParameterTypes"),
    (Service::SetParameters, "~/set_parameters", "rcl_interfaces", "SetParameters"),
    (Service::SetParametersAtomically, "~/set_parameters_atomically", "rcl_interfaces", "SetParametersAtomically"),
    (Service::ListParameters, "~/list_parameters", "rcl_interfaces", "ListParameters"),
    (Service::DescribeParameters, "~/describe_parameters", "rcl_interfaces", "DescribeParameters"),
];

impl Service {
    /// All services.
    pub fn all() -> impl Iterator<Item = Self> {
        SERVICES.iter().map(|(service, ..)| *service)
    }

    /// The name, below that of the node.
    pub fn default_name(self) -> &'static str {
        SERVICES[self as usize].1
    }

    /// The type: a package and a name.
    pub fn type_name(self) -> (&'static str, &'static str) {
        let (_, _, package, kind) = SERVICES[self as usize];
        (package, kind)
    }
}

/// What a service is asked. Services with the same fields have the same variant.
#[derive(Clone, Debug, PartialEq)]
pub enum Call {
    /// Nothing beside the call itself.
    Nothing,
    /// The name of a file.
    Name(String),
    /// A file, and where the robot is in it.
    Deserialize(Deserialize),
    /// A transition.
    Transition(Labelled),
    /// Names of parameters.
    Names(Vec<String>),
    /// Which parameters are listed.
    Prefixes(Prefixes),
    /// Parameters with their new values.
    Parameters(Vec<Parameter>),
}

/// What a service answers. Services with the same fields have the same variant. Only its content is written.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(untagged)]
pub enum Reply {
    /// Whether it is done, and one sentence.
    Trigger(Trigger),
    /// A code of `slam_toolbox`; 0 is success.
    Code(u8),
    /// Whether it is done.
    Success(bool),
    /// A state.
    State(Labelled),
    /// States.
    States(Vec<Labelled>),
    /// Transitions.
    Transitions(Vec<Transition>),
    /// Values of parameters.
    Values(Vec<ParameterValue>),
    /// Types of parameters.
    Types(Vec<u8>),
    /// What became of each parameter.
    Results(Vec<SetResult>),
    /// What became of all parameters.
    Result(SetResult),
    /// Names of parameters.
    Listed(Listed),
    /// Descriptions of parameters.
    Descriptions(Vec<Description>),
}

impl Reply {
    /// The sentences in it.
    pub(crate) fn texts_mut(&mut self) -> Vec<&mut String> {
        match self {
            Self::Trigger(trigger) => vec![&mut trigger.text],
            Self::Result(result) => vec![&mut result.reason],
            Self::Results(all) => all.iter_mut().map(|result| &mut result.reason).collect(),
            Self::Descriptions(all) => all
                .iter_mut()
                .flat_map(|one| [&mut one.description, &mut one.additional_constraints])
                .collect(),
            _ => Vec::new(),
        }
    }

    /// The answer without its content, for one that is too long.
    pub(crate) fn emptied(self) -> Self {
        match self {
            Self::States(_) => Self::States(Vec::new()),
            Self::Transitions(_) => Self::Transitions(Vec::new()),
            Self::Values(_) => Self::Values(Vec::new()),
            Self::Types(_) => Self::Types(Vec::new()),
            Self::Results(_) => Self::Results(Vec::new()),
            Self::Listed(_) => Self::Listed(Listed::default()),
            Self::Descriptions(_) => Self::Descriptions(Vec::new()),
            // Of one length, without their texts.
            reply @ (Self::Trigger(_)
            | Self::Code(_)
            | Self::Success(_)
            | Self::State(_)
            | Self::Result(_)) => reply,
        }
    }
}

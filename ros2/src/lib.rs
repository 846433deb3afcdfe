//! Live nodes for ROS 2, without an installation of ROS. It must not know metrics, trials or reports, and
//! nothing depends on it.
//!
//! ```text
//! network ─Event─▶ Link ─▶ Source ─reading─▶ Robot::step ─command─▶ Link ─Message─▶ network
//! ```
//!
//! - [`CuriousNode`]: the robot of this project on a live robot. What arrives becomes readings; each reading is one
//!   [`robot::Robot::step`]; maps, transforms and commands are published.
//! - [`SimulatedRobot`]: a simulated world as a robot of ROS, as `stage_ros2` is for Stage.
//! - [`Link`]: what both need of a network. [`DdsLink`] is the only implementation that knows the client library; the tests
//!   have one without a network.

mod dds;
mod environment;
mod guard;
mod lifecycle;
mod link;
mod maps;
mod message;
mod names;
mod node;
pub mod node_program;
mod node_state_file;
mod notes;
mod parameters;
mod params_file;
mod pilot;
mod ros_args;
mod service;
mod simulated;
mod source;
#[cfg(test)]
mod tests;
mod topic;
mod value;
mod wiring;

pub use dds::DdsLink;
pub use environment::Environment;
pub use guard::Guard;
pub use link::Link;
pub use names::Names;
pub use node::{CuriousNode, Signals};
pub use parameters::Parameters;
pub use ros_args::RosArgs;
pub use service::Service;
pub use simulated::{SimulatedRobot, SimulationSettings};
pub use source::ScanCount;
pub use topic::Topic;
pub use value::{Given, Value};
pub use wiring::{curious_wiring, simulation_wiring};

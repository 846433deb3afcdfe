//! What a node needs of ROS: to send, to receive, and to answer. One implementation speaks DDS; tests have another one.

use crate::message::{Message, PoseStamped, Quality, Topic};
use std::time::Duration;

/// The connection of a node with other nodes. No method fails: what goes wrong is an [`Event::Problem`].
pub trait Link {
    /// Sends a message. `false`: it was not sent, since a subscriber does not keep up.
    fn send(&mut self, topic: Topic, message: Message) -> bool;

    /// The full name of a topic that the node publishes.
    fn name(&self, topic: Topic) -> &str;

    /// The next event. Waits for it at most this long.
    fn receive(&mut self, patience: Duration) -> Option<Event>;

    /// Answers a request.
    fn answer(&mut self, request: Request, answer: Answer);

    /// Asks Nav2 to drive to a pose; `None` cancels the goal. What becomes of the goal are events.
    fn navigate(&mut self, goal: Option<PoseStamped>);
}

/// A request of the service that saves the state; the link knows who has asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request(pub u64);

/// The answer to a request, as `std_srvs/Trigger` has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Whether it is done.
    pub is_done: bool,
    /// One sentence.
    pub text: String,
}

/// What comes from other nodes.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A message.
    Message(Topic, Message),
    /// A request to save the state.
    SaveState(Request),
    /// The state of the goal that Nav2 has.
    Navigation(Navigation),
    /// Something that cannot be used, in one sentence.
    Problem(String),
}

/// The state of a goal that was given to Nav2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Navigation {
    /// Nav2 drives there.
    Accepted,
    /// Nav2 does not drive there, or there is no Nav2.
    Refused,
    /// The robot is there.
    Reached,
    /// Nav2 has given the goal up.
    GivenUp,
}

/// What a node wants of the network.
#[derive(Clone, Debug, PartialEq)]
pub struct Wiring {
    /// The name of the node.
    pub name: String,
    /// Its namespace: `/`, or as `/robot`.
    pub namespace: String,
    /// The topics that it subscribes, each with its full name.
    pub subscribed: Vec<(Topic, String, Quality)>,
    /// The topics that it publishes, each with its full name.
    pub published: Vec<(Topic, String, Quality)>,
    /// The full name of the service that saves the state.
    pub save_state: Option<String>,
    /// The full name of the action of Nav2 that drives to a pose.
    pub navigate_to_pose: Option<String>,
    /// The parameters that other nodes can read.
    pub parameters: Vec<(String, crate::value::Value)>,
}

//! What a node needs of ROS: to send, to receive, and to answer. One implementation speaks DDS; tests have another one.

use crate::message::{DynamicEdges, Message, PoseStamped, Quality, Topic};
use crate::service::{Call, Reply, Service};
use std::time::Duration;

/// The connection of a node with other nodes. No method fails: what goes wrong is an event.
pub trait Link {
    /// Sends a message. `false`: it was not sent, since a subscriber does not keep up.
    fn send(&mut self, topic: Topic, message: Message) -> bool;

    /// The full name of a topic that the node publishes.
    fn name(&self, topic: Topic) -> &str;

    /// The full name of the node.
    fn node(&self) -> &str;

    /// The next event. Waits for it at most this long.
    fn receive(&mut self, patience: Duration) -> Option<Event>;

    /// Answers a request.
    fn answer(&mut self, request: Request, reply: Reply);

    /// Asks Nav2 to drive to a pose; `None` cancels the goal. What becomes of the goal are events.
    fn navigate(&mut self, goal: Option<PoseStamped>);

    /// Asks `nav2_route` to adjust edges. Whether it has is an event.
    fn adjust_edges(&mut self, edges: DynamicEdges);
}

/// A request: of which service, of which client, and the number that the client has given it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Request {
    /// The service that is called.
    pub service: Service,
    /// The identity of the client on the network.
    pub client: [u8; 16],
    /// The number of the request among those of its client.
    pub number: i64,
}

/// What comes from other nodes.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A message.
    Message(Topic, Message),
    /// A service is called, and must be answered.
    Call(Request, Call),
    /// The state of the goal that Nav2 has.
    Navigation(Navigation),
    /// Whether `nav2_route` has adjusted the edges.
    EdgesAdjusted(bool),
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
    /// The services that it offers, each with its full name.
    pub services: Vec<(Service, String)>,
    /// The full name of the action of Nav2 that drives to a pose.
    pub navigate_to_pose: Option<String>,
    /// The full name of the service of `nav2_route` that adjusts edges.
    pub adjust_edges: Option<String>,
}

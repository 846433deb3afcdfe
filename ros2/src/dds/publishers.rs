//! What the node sends.

use super::others::Endpoints;
use super::{WAIT, profile};
use crate::link::Wiring;
use crate::message::{Message, Topic};
use ros2_client::qos::WhenFull;
use ros2_client::{Gid, MessageTypeName, Name, Publisher, WriteError};
use std::collections::{BTreeMap, BTreeSet};

/// The publishers of a node.
pub(super) struct Publishers {
    by_topic: BTreeMap<Topic, Publisher<Message>>,
    problem: Option<String>,
}

impl Publishers {
    pub(super) fn new(endpoints: &mut Endpoints, wiring: &Wiring) -> anyhow::Result<Self> {
        let mut by_topic = BTreeMap::new();
        for (topic, name, quality) in &wiring.published {
            let (package, kind) = topic.type_name();
            // The robot does not wait for a subscriber that does not keep up: the next message replaces this one. A map, or a scan of
            // the simulator, is not replaced so soon.
            let is_waiting = quality.is_latched || *topic == Topic::Scan;
            let profile = profile(quality, if is_waiting { WhenFull::Wait(WAIT) } else { WhenFull::Fail });
            let node = endpoints.node();
            let on = node.create_topic(&Name::parse(name)?, MessageTypeName::new(package, kind), &profile)?;
            by_topic.insert(*topic, node.create_publisher(&on, None)?);
        }
        Ok(Self { by_topic, problem: None })
    }

    /// The publishers of this node, on the network.
    pub(super) fn ids(&self) -> BTreeSet<Gid> {
        self.by_topic.values().map(Publisher::gid).collect()
    }

    /// Sends a message; `false` if it is not sent.
    pub(super) fn send(&mut self, topic: Topic, message: Message) -> bool {
        let Some(publisher) = self.by_topic.get(&topic) else { return true };
        let Err(why) = publisher.publish(message) else { return true };
        let why = match why {
            WriteError::WouldBlock { .. } => "a subscriber does not keep up".to_owned(),
            why => why.to_string(),
        };
        self.problem = Some(format!("a message on `{}` was not sent: {why}", topic.default_name()));
        false
    }

    /// Why a message was not sent since the last call.
    pub(super) fn take_problem(&mut self) -> Option<String> {
        self.problem.take()
    }
}

//! What the node sends.

use super::others::Endpoints;
use super::{WAIT, profile};
use crate::link::Wiring;
use crate::message::{Message, Quality, Topic};
use ros2_client::qos::WhenFull;
use ros2_client::{Gid, MessageTypeName, Name, Node, WriteError};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Sends a message of one type.
type Send = Box<dyn Fn(Message) -> Result<(), String>>;

/// The publishers of a node.
pub(super) struct Publishers {
    by_topic: BTreeMap<Topic, Send>,
    ids: BTreeSet<Gid>,
    problem: Option<String>,
}

impl Publishers {
    pub(super) fn new(endpoints: &mut Endpoints, wiring: &Wiring) -> anyhow::Result<Self> {
        let (mut by_topic, mut ids) = (BTreeMap::new(), BTreeSet::new());
        for (topic, name, quality) in &wiring.published {
            let at = (*topic, name.as_str(), quality);
            macro_rules! publisher {
                ($variant:ident) => {
                    open(endpoints.node(), at, |message| match message {
                        Message::$variant(content) => Some(content),
                        _ => None,
                    })
                };
            }
            let (send, id) = by_type!(topic, publisher)?;
            by_topic.insert(*topic, send);
            ids.insert(id);
        }
        Ok(Self { by_topic, ids, problem: None })
    }

    /// The publishers of this node, on the network.
    pub(super) fn ids(&self) -> BTreeSet<Gid> {
        self.ids.clone()
    }

    /// Sends a message; `false` if it is not sent.
    pub(super) fn send(&mut self, topic: Topic, message: Message) -> bool {
        let Some(Err(why)) = self.by_topic.get(&topic).map(|send| send(message)) else { return true };
        self.problem = Some(format!("a message on `{}` was not sent: {why}", topic.default_name()));
        false
    }

    /// Why a message was not sent since the last call.
    pub(super) fn take_problem(&mut self) -> Option<String> {
        self.problem.take()
    }
}

fn open<M: Serialize + 'static>(
    node: &mut Node,
    (topic, name, quality): (Topic, &str, &Quality),
    content: fn(Message) -> Option<M>,
) -> anyhow::Result<(Send, Gid)> {
    let (package, kind) = topic.type_name();
    // The robot does not wait for a subscriber that does not keep up: the next message replaces this one. A map, or a scan of the
    // simulator, is not replaced so soon.
    let is_waiting = quality.is_latched || topic == Topic::Scan;
    let profile = profile(quality, if is_waiting { WhenFull::Wait(WAIT) } else { WhenFull::Fail });
    let on = node.create_topic(&Name::parse(name)?, MessageTypeName::new(package, kind), &profile)?;
    let publisher = node.create_publisher::<M>(&on, None)?;
    let id = publisher.gid();
    let send = move |message| {
        let content = content(message).ok_or("it has another type")?;
        publisher.publish(content).map_err(|why| match why {
            WriteError::WouldBlock { .. } => "a subscriber does not keep up".to_owned(),
            why => why.to_string(),
        })
    };
    Ok((Box::new(send), id))
}

//! What the node sends.

use super::others::Endpoints;
use super::{WAIT, profile};
use crate::link::Wiring;
use crate::message::{Message, Quality, Topic};
use ros2_client::qos::WhenFull;
use ros2_client::{MessageTypeName, Name, Publisher};
use std::collections::BTreeMap;

/// The topics of a node that it publishes, each with its full name.
pub(super) type Publishers = BTreeMap<Topic, (String, Publisher<Message>)>;

/// Opens the publishers of a node.
pub(super) fn open(endpoints: &mut Endpoints, wiring: &Wiring) -> anyhow::Result<Publishers> {
    let open = |(topic, name, quality): &(Topic, String, Quality)| {
        let (package, kind) = topic.type_name();
        // The robot does not wait for a subscriber that does not keep up: the next message replaces this one. A map, or a scan of
        // the simulator, is not replaced so soon.
        let is_waiting = quality.is_latched || *topic == Topic::Scan;
        let profile = profile(quality, if is_waiting { WhenFull::Wait(WAIT) } else { WhenFull::Fail });
        let node = endpoints.node();
        let on = node.create_topic(&Name::parse(name)?, MessageTypeName::new(package, kind), &profile)?;
        Ok((*topic, (name.clone(), node.create_publisher(&on, None)?)))
    };
    wiring.published.iter().map(open).collect()
}

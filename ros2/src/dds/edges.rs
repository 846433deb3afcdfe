//! The service of `nav2_route` that closes edges and adjusts their costs.

use super::services::Flag;
use super::{WAIT, profile};
use crate::message::{DynamicEdges, Quality};
use ros2_client::qos::WhenFull;
use ros2_client::{Client, Message, Name, Node, RmwRequestId, ServiceMapping, ServiceTypeName};
use std::time::{Duration, Instant};

/// The service answers at once, or it is not there.
const PATIENCE: Duration = Duration::from_secs(3);

impl Message for DynamicEdges {}

/// A client of the service.
pub(super) struct EdgesClient {
    client: Client<DynamicEdges, Flag>,
    asked: Option<(Option<RmwRequestId>, Instant)>,
}

impl EdgesClient {
    pub(super) fn new(node: &mut Node, name: &str, mapping: ServiceMapping) -> anyhow::Result<Self> {
        let quality = profile(&Quality::DEFAULT, WhenFull::Wait(WAIT));
        let kind = ServiceTypeName::new("nav2_msgs", "DynamicEdges");
        let client = node.create_client(mapping, &Name::parse(name)?, &kind, quality.clone(), quality)?;
        Ok(Self { client, asked: None })
    }

    /// Whether an answer is expected.
    pub(super) fn is_busy(&self) -> bool {
        self.asked.is_some()
    }

    /// Sends a request; an earlier one is forgotten, but for how long there was no answer.
    pub(super) fn send(&mut self, edges: DynamicEdges) {
        let since = self.asked.map_or_else(Instant::now, |(_, since)| since);
        self.asked = Some((self.client.send_request(edges).ok(), since));
    }

    /// Whether the edges are adjusted; `None` while nothing was asked, or an answer can still come.
    pub(super) fn poll(&mut self) -> Option<bool> {
        let (asked, since) = self.asked?;
        while let Ok(Some((answered, Flag(is_done)))) = self.client.receive_response() {
            if Some(answered) == asked {
                self.asked = None;
                return Some(is_done);
            }
        }
        if asked.is_some() && since.elapsed() < PATIENCE {
            return None;
        }
        self.asked = None;
        Some(false)
    }
}

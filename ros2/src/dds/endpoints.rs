//! Publishers, subscriptions and services are announced one after another, and not while another participant learns who is there.

use super::others::Others;
use ros2_client::Node;
use std::time::Duration;

/// A participant has asked for what was announced before it came, and has got it, within this time; on a busy machine as well.
const QUIET: Duration = Duration::from_millis(300);
/// In a network in which participants come and go, the node does not wait for longer than this altogether.
const PATIENCE: Duration = Duration::from_secs(5);
const POLL: Duration = Duration::from_millis(5);

/// A node, to which endpoints are added.
///
/// Recorded packets show that Fast DDS (3.2) can drop announcements without a word, so that their topics are never matched: this happens
/// if a new one arrives between its request for earlier ones and the answer. The probable reason is that it keeps announcements without
/// a source timestamp, as those of our library, in the order in which they arrive. Without a pause, 8 of 20 starts of two nodes and a
/// participant of Fast DDS at the same time lost a topic or a node.
pub(super) struct Endpoints {
    node: Node,
    others: Others,
    patience: Duration,
}

impl Endpoints {
    pub(super) fn new(node: Node, others: Others) -> Self {
        Self { node, others, patience: PATIENCE }
    }

    /// The node, as soon as no participant is being discovered.
    pub(super) fn node(&mut self) -> &mut Node {
        while self.others.quiet() < QUIET && !self.patience.is_zero() {
            std::thread::sleep(POLL);
            self.patience = self.patience.saturating_sub(POLL);
        }
        &mut self.node
    }
}

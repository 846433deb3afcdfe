//! What this node hears of other participants: when one is discovered, and when its readers and writers match with those of this
//! node. The first call of a service depends on it.

use crate::link::Event;
use crate::message::{Quality, Topic};
use futures::executor::block_on_stream;
use ros2_client::dds::rustdds::policy::Reliability;
use ros2_client::dds::rustdds::{
    DomainParticipantStatusEvent, EndpointDescription, GUID, RTPSEntity, StatusEvented,
};
use ros2_client::{Context, Node};
use std::collections::BTreeSet;
use std::net::{SocketAddr, UdpSocket};
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// The bytes of an identity that say of which participant it is, in the headers of all vendors.
const PARTICIPANT: usize = 8;
/// The first bytes of the identities of Fast DDS.
const FAST_DDS: [u8; 2] = [0x01, 0x0f];
/// The times before the messages that ask for a request again.
const WAITS: [Duration; 2] = [Duration::from_millis(20), Duration::from_millis(150)];
/// Topics of requests begin with this.
const REQUESTS: &str = "rq/";

/// The other participants.
#[derive(Clone)]
pub(super) struct Others {
    context: Context,
    known: Arc<Mutex<Known>>,
}

struct Known {
    /// When the last participant was discovered.
    newest: Instant,
    /// The readers of others that a writer of this node is matched with.
    matched: BTreeSet<GUID>,
}

impl Others {
    /// Follows what is heard, in a thread of its own, and reports publishers that cannot be heard. The participant of this node has just been opened: all that are there discover
    /// it now.
    pub(super) fn follow(
        context: &Context,
        subscribed: Vec<Named>,
        problems: SyncSender<Event>,
    ) -> std::io::Result<Self> {
        let known = Arc::new(Mutex::new(Known { newest: Instant::now(), matched: BTreeSet::new() }));
        let (to, of) = (known.clone(), context.clone());
        let socket = UdpSocket::bind(("0.0.0.0", 0)).ok();
        std::thread::Builder::new().name("matches".to_owned()).spawn(move || {
            let news = of.domain_participant().status_listener();
            for event in block_on_stream(news.as_async_status_stream()) {
                let Ok(mut known) = to.lock() else { return };
                match event {
                    DomainParticipantStatusEvent::WriterDetected { writer } => {
                        if let Some(problem) = problem(&subscribed, &writer) {
                            // If the node does not keep up, it has other problems.
                            problems.try_send(Event::Problem(problem)).ok();
                        }
                    }
                    DomainParticipantStatusEvent::ParticipantDiscovered { .. } => {
                        known.newest = Instant::now();
                    }
                    DomainParticipantStatusEvent::RemoteReaderMatched { remote_reader, .. } => {
                        known.matched.insert(remote_reader);
                    }
                    DomainParticipantStatusEvent::ReaderLost { guid, .. } => {
                        known.matched.remove(&guid);
                    }
                    DomainParticipantStatusEvent::RemoteWriterMatched { local_reader, remote_writer } => {
                        if let Some(socket) = &socket {
                            ask_again(&of, socket, &local_reader, &remote_writer);
                        }
                    }
                    _ => {}
                }
            }
        })?;
        Ok(Self { context: context.clone(), known })
    }

    /// The time since the last participant was discovered.
    pub(super) fn quiet(&self) -> Duration {
        self.known.lock().map_or(Duration::MAX, |known| known.newest.elapsed())
    }

    /// Whether the participant of a client has a matched reader of a topic.
    pub(super) fn has(&self, topic: &str, client: &[u8; 16]) -> bool {
        let Ok(known) = self.known.lock() else { return true };
        let readers = self.context.domain_participant().discovered_readers();
        readers.iter().any(|reader| {
            let guid = reader.reader_proxy.remote_reader_guid;
            known.matched.contains(&guid)
                && guid.to_bytes()[..PARTICIPANT] == client[..PARTICIPANT]
                && reader.subscription_topic_data.topic_name() == topic
        })
    }
}

/// A topic with its full name.
type Named = (Topic, String, Quality);

/// Why a publisher cannot be heard by a node with these subscriptions, in a sentence; `None` if it can, or has another topic.
fn problem(subscribed: &[Named], found: &EndpointDescription) -> Option<String> {
    let name = found.topic_name.strip_prefix("rt")?;
    let mine = || subscribed.iter().filter(|(_, mine, _)| mine == name);
    let (expected, ..) = mine().next()?;
    let Some((.., quality)) = mine().find(|(topic, ..)| dds_type(*topic) == found.type_name) else {
        let (found, expected) = (ros_type(&found.type_name), ros_type(&dds_type(*expected)));
        return Some(format!("a publisher of `{name}` has the type {found}, not {expected}: it is ignored"));
    };
    let is_reliable = matches!(found.qos.reliability(), Some(Reliability::Reliable { .. }));
    (quality.is_reliable && !is_reliable).then(|| {
        format!("a publisher of `{name}` is not reliable, and this node asks for that: it is not heard")
    })
}

/// The type of a topic on the wire.
pub(super) fn dds_type(topic: Topic) -> String {
    let (package, kind) = topic.type_name();
    format!("{package}::msg::dds_::{kind}_")
}

/// A type as ROS writes it: `sensor_msgs/msg/LaserScan` for `sensor_msgs::msg::dds_::LaserScan_`.
pub(super) fn ros_type(dds: &str) -> String {
    dds.replace("::dds_::", "/").replace("::", "/").trim_end_matches('_').to_owned()
}

/// Asks a client of Fast DDS for the request that it has sent before this node knew it, and which this node has therefore dropped.
///
/// The library does ask (a preemptive ACKNACK), but numbers its first message with 0. Fast DDS takes only numbers above the last one,
/// which is 0 at the begin, so that the request comes with its next heartbeat, after three seconds. These messages have the numbers
/// 1 and 2. A sample that is on its way is not sent again, so that they wait a little.
fn ask_again(context: &Context, socket: &UdpSocket, reader: &GUID, writer: &GUID) {
    if writer.to_bytes()[..2] != FAST_DDS {
        return;
    }
    let participant = context.domain_participant();
    let writers = participant.discovered_writers();
    let found = writers.iter().find(|found| found.writer_proxy.remote_writer_guid == *writer);
    let Some(found) = found.filter(|found| found.publication_topic_data.topic_name.starts_with(REQUESTS))
    else {
        return;
    };
    let locators = found.writer_proxy.unicast_locator_list.iter().filter(|locator| locator.is_udp());
    let to: Vec<SocketAddr> = locators.map(|locator| SocketAddr::from(*locator)).collect();
    let ids = [participant.guid(), *reader, *writer].map(|guid| guid.to_bytes());
    let Ok(socket) = socket.try_clone() else { return };
    let ask = move || {
        for (wait, count) in WAITS.into_iter().zip(1..) {
            std::thread::sleep(wait);
            for to in &to {
                // If it is lost, the request comes with the heartbeat.
                socket.send_to(&acknack(&ids, count), to).ok();
            }
        }
    };
    std::thread::Builder::new().name("ask_again".to_owned()).spawn(ask).ok();
}

/// The message of RTPS by which a reader asks a writer for its first sample (RTPS 2.5, 8.3.8.1 and 9.4.5.3). Fast DDS ignores a
/// message that asks for more than the writer has written.
fn acknack([own, reader, writer]: &[[u8; 16]; 3], count: u32) -> Vec<u8> {
    const VERSION_AND_VENDOR: [u8; 4] = [2, 4, 0x01, 0x12];
    const LITTLE_ENDIAN: u8 = 1;
    const FINAL: u8 = 2;
    let mut message = b"RTPS".to_vec();
    message.extend(VERSION_AND_VENDOR);
    message.extend(&own[..12]);
    message.extend([0x0e, LITTLE_ENDIAN, 12, 0]); // INFO_DST
    message.extend(&writer[..12]);
    message.extend([0x06, LITTLE_ENDIAN | FINAL, 28, 0]); // ACKNACK
    message.extend(&reader[12..]);
    message.extend(&writer[12..]);
    let (base_high, base_low, bits, bitmap) = (0_u32, 1_u32, 1_u32, 1_u32 << 31);
    for word in [base_high, base_low, bits, bitmap, count] {
        message.extend(word.to_le_bytes());
    }
    message
}

/// A participant has asked for what was announced before it came, and has got it, within this time; on a busy machine as well.
const QUIET: Duration = Duration::from_millis(300);
/// In a network in which participants come and go, the node does not wait for longer than this altogether.
const ENDPOINT_PATIENCE: Duration = Duration::from_secs(5);
const ENDPOINT_POLL: Duration = Duration::from_millis(5);

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
        Self { node, others, patience: ENDPOINT_PATIENCE }
    }

    /// The node, as soon as no participant is being discovered.
    pub(super) fn node(&mut self) -> &mut Node {
        while self.others.quiet() < QUIET && !self.patience.is_zero() {
            std::thread::sleep(ENDPOINT_POLL);
            self.patience = self.patience.saturating_sub(ENDPOINT_POLL);
        }
        &mut self.node
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_has_the_layout_of_rtps() {
        let message = acknack(&[[1; 16], [2; 16], [3; 16]], 1);
        // Header 20, INFO_DST 4 + 12, ACKNACK 4 + 28.
        assert_eq!(message.len(), 68);
        assert_eq!(message[36..40], [6, 3, 28, 0]);
        assert_eq!(message[40..48], [2, 2, 2, 2, 3, 3, 3, 3]);
        assert_eq!(message[48..60], [0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
        assert_eq!(message[60..], [0, 0, 0, 128, 1, 0, 0, 0]);
    }
}

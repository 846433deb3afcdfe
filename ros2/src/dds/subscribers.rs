//! What the node receives: a thread that waits for all topics at once.

use super::others::{Endpoints, dds_type, ros_type};
use super::profile;
use crate::link::{Event, Wiring};
use crate::message::{Message, Quality, Topic};
use anyhow::bail;
use futures::executor::block_on_stream;
use futures::stream::{BoxStream, StreamExt, select_all, unfold};
use ros2_client::qos::WhenFull;
use ros2_client::{Context, Gid, MessageInfo, MessageTypeName, Name, Node, ReadError};
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::mpsc::SyncSender;

/// A message, or why it is none, on a topic.
type Received = (Topic, Result<(Message, MessageInfo), ReadError>);

/// Subscribes the topics of a node, and sends what comes to `to`. `own` are the publishers of this node.
pub(super) fn start(
    endpoints: &mut Endpoints,
    context: &Context,
    wiring: &Wiring,
    own: BTreeSet<Gid>,
    to: SyncSender<Event>,
) -> anyhow::Result<()> {
    let mut streams = Vec::new();
    for (topic, name, quality) in &wiring.subscribed {
        let (node, at) = (endpoints.node(), (*topic, name.as_str(), quality));
        streams.push(match topic {
            Topic::Scan => open(node, at, Message::Scan),
            Topic::Odometry => open(node, at, Message::Odometry),
            Topic::Transforms | Topic::StaticTransforms => open(node, at, Message::Transforms),
            Topic::Velocity => open(node, at, Message::Twist),
            Topic::StampedVelocity => open(node, at, Message::TwistStamped),
            Topic::Resume => open(node, at, Message::Bool),
            Topic::InitialPose => open(node, at, Message::PoseWithCovariance),
            _ => bail!("no node subscribes `{name}`"),
        }?);
    }
    let mut filter = Filter { context: context.clone(), own, known: BTreeMap::new() };
    std::thread::Builder::new().name("subscribers".to_owned()).spawn(move || {
        for received in block_on_stream(select_all(streams)) {
            if let Some(event) = filter.event(received)
                && to.send(event).is_err()
            {
                return; // The node has ended.
            }
        }
    })?;
    Ok(())
}

fn open<M: DeserializeOwned + Send + Sync + 'static>(
    node: &mut Node,
    (topic, name, quality): (Topic, &str, &Quality),
    message: fn(M) -> Message,
) -> anyhow::Result<BoxStream<'static, Received>> {
    let (package, kind) = topic.type_name();
    let on = node.create_topic(
        &Name::parse(name)?,
        MessageTypeName::new(package, kind),
        &profile(quality, WhenFull::Fail),
    )?;
    let subscription = node.create_subscription::<M>(&on, None)?;
    let stream = unfold(subscription, move |subscription| async move {
        let taken = subscription.async_take().await;
        let content = taken.map(|(content, info)| (message(content), info));
        Some(((topic, content), subscription))
    });
    Ok(stream.boxed())
}

/// Lets messages through that come from others, and have the type of the topic: DDS matches topics by name alone.
struct Filter {
    context: Context,
    own: BTreeSet<Gid>,
    /// The types of the publishers that were seen.
    known: BTreeMap<Gid, String>,
}

/// Maximum number of publishers that are remembered: nodes come and go.
const MAX_KNOWN: usize = 1000;

impl Filter {
    fn event(&mut self, (topic, content): Received) -> Option<Event> {
        let expected = dds_type(topic);
        let (message, info) = match content {
            Ok(content) => content,
            // A topic with two types is read with both.
            Err(ReadError::Deserialization { .. })
                if matches!(topic, Topic::Velocity | Topic::StampedVelocity) =>
            {
                return None;
            }
            Err(why) => {
                let (name, kind) = (topic.default_name(), ros_type(&expected));
                return Some(Event::Problem(format!(
                    "a message on `{name}` cannot be read as {kind}: {why}"
                )));
            }
        };
        let publisher = info.publisher_gid();
        if self.own.contains(&publisher) {
            return None;
        }
        // What has another type is reported where publishers are discovered.
        let is_other = self.type_of(publisher).is_some_and(|found| found != expected);
        (!is_other).then_some(Event::Message(topic, message))
    }

    /// The type of a publisher; `None` if it is not known yet.
    fn type_of(&mut self, publisher: Gid) -> Option<String> {
        if let Some(known) = self.known.get(&publisher) {
            return Some(known.clone());
        }
        let writers = self.context.domain_participant().discovered_writers();
        let is_this = |guid| Gid::from(guid) == publisher;
        let found = writers.into_iter().find(|writer| is_this(writer.writer_proxy.remote_writer_guid))?;
        if self.known.len() >= MAX_KNOWN {
            self.known.clear();
        }
        let found = found.publication_topic_data.type_name;
        self.known.insert(publisher, found.clone());
        Some(found)
    }
}

//! Topics that others publish with one of two types, as velocities: each is subscribed when somebody publishes with its type, so that
//! the topic has one type.

use super::discovery::dds_type;
use super::endpoints::Endpoints;
use super::subscribers::{self, Named};
use crate::link::Event;
use ros2_client::{Context, Gid};
use std::collections::BTreeSet;
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

/// The time between two looks at what is published.
const EVERY: Duration = Duration::from_millis(200);

/// The topics that are not subscribed yet.
pub(super) struct Typed {
    context: Context,
    waiting: Vec<Named>,
    own: BTreeSet<Gid>,
    to: SyncSender<Event>,
    next: Instant,
}

impl Typed {
    /// Takes out of `topics` those that have a name in common. What comes is sent to `to`; `own` are the publishers of this node.
    pub(super) fn new(
        topics: Vec<Named>,
        context: Context,
        own: BTreeSet<Gid>,
        to: SyncSender<Event>,
    ) -> (Self, Vec<Named>) {
        let count = |name: &String| topics.iter().filter(|(_, other, _)| other == name).count();
        let (waiting, topics) = topics.iter().cloned().partition(|(_, name, _)| count(name) > 1);
        (Self { context, waiting, own, to, next: Instant::now() }, topics)
    }

    /// Subscribes topics that somebody publishes with their type. An error is one sentence.
    pub(super) fn open(&mut self, endpoints: &mut Endpoints) -> Option<String> {
        if self.waiting.is_empty() || Instant::now() < self.next {
            return None;
        }
        self.next = Instant::now() + EVERY;
        let writers = self.context.domain_participant().discovered_writers();
        let is_published = |(topic, name, _): &mut Named| {
            let is_this = |data: &ros2_client::dds::rustdds::discovery::PublicationBuiltinTopicData| {
                data.topic_name.strip_prefix("rt") == Some(name) && data.type_name == dds_type(*topic)
            };
            writers.iter().any(|writer| is_this(&writer.publication_topic_data))
        };
        let published: Vec<Named> = self.waiting.extract_if(.., is_published).collect();
        if published.is_empty() {
            return None;
        }
        let opened = subscribers::start(endpoints, &self.context, &published, self.own.clone(), &self.to);
        opened.err().map(|why| format!("a topic cannot be subscribed: {why:#}"))
    }
}

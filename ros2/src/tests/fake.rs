//! A link without a network, for tests.

use crate::link::{Event, Link, Request};
use crate::message::{DynamicEdges, Message, PoseStamped, Topic};
use crate::service::{Call, Reply, Service};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// What other nodes send, and what they hear.
#[derive(Debug, Default)]
pub(crate) struct Others {
    pub(crate) events: VecDeque<Event>,
    /// Whether they do not keep up.
    pub(crate) is_slow: bool,
    pub(crate) heard: Vec<(Topic, Message)>,
    pub(crate) answers: Vec<(Request, Reply)>,
    pub(crate) goals: Vec<Option<PoseStamped>>,
    pub(crate) edges: Vec<DynamicEdges>,
}

/// A link to [`Others`].
#[derive(Clone, Debug, Default)]
pub(crate) struct FakeLink(pub(crate) Arc<Mutex<Others>>);

impl FakeLink {
    pub(crate) fn others<T>(&self, with: impl FnOnce(&mut Others) -> T) -> T {
        with(&mut self.0.lock().unwrap())
    }

    pub(crate) fn sends(&self, topic: Topic, message: Message) {
        self.others(|others| others.events.push_back(Event::Message(topic, message)));
    }

    /// Calls a service.
    pub(crate) fn calls(&self, number: i64, service: Service, call: Call) {
        let request = Request { service, client: [0; 16], number };
        self.others(|others| others.events.push_back(Event::Call(request, call)));
    }

    /// The last answer, which is taken.
    pub(crate) fn answer(&self) -> Option<(i64, Reply)> {
        self.others(|others| others.answers.pop()).map(|(request, reply)| (request.number, reply))
    }

    /// The messages on a topic so far.
    pub(crate) fn heard(&self, topic: Topic) -> Vec<Message> {
        self.others(|others| {
            let on = others.heard.iter().filter(|(other, _)| *other == topic);
            on.map(|(_, message)| message.clone()).collect()
        })
    }
}

impl Link for FakeLink {
    fn send(&mut self, topic: Topic, message: Message) -> bool {
        self.others(|others| {
            if !others.is_slow {
                others.heard.push((topic, message));
            }
            !others.is_slow
        })
    }

    fn name(&self, topic: Topic) -> &str {
        topic.default_name()
    }

    fn node(&self) -> &str {
        "/curious_node"
    }

    fn receive(&mut self, _: Duration) -> Option<Event> {
        self.others(|others| others.events.pop_front())
    }

    fn answer(&mut self, request: Request, reply: Reply) {
        self.others(|others| others.answers.push((request, reply)));
    }

    fn navigate(&mut self, goal: Option<PoseStamped>) {
        self.others(|others| others.goals.push(goal));
    }

    fn adjust_edges(&mut self, edges: DynamicEdges) {
        self.others(|others| others.edges.push(edges));
    }
}

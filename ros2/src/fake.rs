//! A link without a network, for tests.

use crate::link::{Answer, Event, Link, Request};
use crate::message::{Message, PoseStamped, Topic};
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
    pub(crate) answers: Vec<(Request, Answer)>,
    pub(crate) goals: Vec<Option<PoseStamped>>,
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

    fn receive(&mut self, _: Duration) -> Option<Event> {
        self.others(|others| others.events.pop_front())
    }

    fn answer(&mut self, request: Request, answer: Answer) {
        self.others(|others| others.answers.push((request, answer)));
    }

    fn navigate(&mut self, goal: Option<PoseStamped>) {
        self.others(|others| others.goals.push(goal));
    }
}

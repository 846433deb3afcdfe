//! The connection by DDS: the only part that knows the client library.

mod actions;
mod others;
mod services;
mod subscribers;

use crate::environment::{Environment, Range};
use crate::link::{Event, Link, Request, Wiring};
use crate::message::{DynamicEdges, Message, PoseStamped, Quality, Topic};
use crate::service::Reply;
use actions::{EdgesClient, Navigator};
use anyhow::Context as _;
use others::{Endpoints, Others};
use ros2_client::dds::rustdds::DomainParticipantBuilder;
use ros2_client::qos::{Durability, History, QosProfile, Reliability, WhenFull};
use ros2_client::{
    Context, MessageTypeName, Name, NodeName, NodeOptions, Publisher, ServiceMapping, WriteError,
};
use services::Services;
use std::collections::{BTreeMap, VecDeque};
use std::net::{IpAddr, Ipv4Addr};
use std::sync::mpsc::{self, Receiver};
use std::time::{Duration, Instant};

/// How long a message that must not be lost waits if a subscriber does not keep up.
const WAIT: Duration = Duration::from_millis(20);
/// The time between two looks at what Nav2 answers.
const POLL: Duration = Duration::from_millis(20);
/// Events that wait for the node. If there are more, messages are lost on the network, as their QoS has it.
const MAX_EVENTS: usize = 4096;

/// The topics that a node publishes, each with its full name.
type Publishers = BTreeMap<Topic, (String, Publisher<Message>)>;

/// A node on the network.
pub struct DdsLink {
    events: Receiver<Event>,
    publishers: Publishers,
    problems: VecDeque<String>,
    navigator: Option<Navigator>,
    edges: Option<EdgesClient>,
    services: Services,
    /// The full name of the node.
    name: String,
    /// Ends the node when it is dropped.
    _endpoints: Endpoints,
}

impl DdsLink {
    /// Opens a node.
    ///
    /// # Errors
    ///
    /// When a name is not valid, or when the network cannot be used.
    pub fn open(wiring: &Wiring, environment: &Environment) -> anyhow::Result<Self> {
        let context = context(environment).context("cannot open the network")?;
        let name = NodeName::new(&wiring.namespace, &wiring.name)?;
        let full_name = format!("{}/{}", wiring.namespace.trim_end_matches('/'), wiring.name);
        // The node answers for its parameters and its log itself: the library does so for one vendor only, and subscribes `/clock`
        // with a type of its own.
        let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
        let (to, events) = mpsc::sync_channel(MAX_EVENTS);
        let others = Others::follow(&context, wiring.subscribed.clone(), to.clone())?;
        let mut endpoints = Endpoints::new(context.new_node(name, options)?, others.clone());
        let is_cyclone = environment.is_cyclone;
        let mapping = if is_cyclone { ServiceMapping::Cyclone } else { ServiceMapping::Enhanced };
        let publishers = publishers(&mut endpoints, wiring)?;
        let own = publishers.values().map(|(_, publisher)| publisher.gid()).collect();
        let navigator = wiring.navigate_to_pose.as_deref();
        let navigator = navigator.map(|name| Navigator::new(endpoints.node(), name, mapping)).transpose()?;
        let edges = wiring.adjust_edges.as_deref();
        let edges = edges.map(|name| EdgesClient::new(endpoints.node(), name, mapping)).transpose()?;
        let services = Services::open(&mut endpoints, others, &wiring.services, mapping, &to)?;
        subscribers::start(&mut endpoints, &context, wiring, own, to)?;
        Ok(Self {
            events,
            publishers,
            problems: VecDeque::new(),
            navigator,
            edges,
            services,
            name: full_name,
            _endpoints: endpoints,
        })
    }

    /// Whether an answer of Nav2 is expected.
    fn is_busy(&self) -> bool {
        self.navigator.as_ref().is_some_and(Navigator::is_busy)
            || self.edges.as_ref().is_some_and(EdgesClient::is_busy)
    }
}

impl Link for DdsLink {
    fn send(&mut self, topic: Topic, message: Message) -> bool {
        let Some((name, publisher)) = self.publishers.get(&topic) else { return true };
        let Err(why) = publisher.publish(message) else { return true };
        let why = match why {
            WriteError::WouldBlock { .. } => "a subscriber does not keep up".to_owned(),
            why => why.to_string(),
        };
        if self.problems.is_empty() {
            self.problems.push_back(format!("a message on `{name}` was not sent: {why}"));
        }
        false
    }

    fn name(&self, topic: Topic) -> &str {
        self.publishers.get(&topic).map_or(topic.default_name(), |(name, _)| name)
    }

    fn node(&self) -> &str {
        &self.name
    }

    fn receive(&mut self, patience: Duration) -> Option<Event> {
        if let Some(problem) = self.problems.pop_front() {
            return Some(Event::Problem(problem));
        }
        let end = Instant::now() + patience;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let nap = if self.is_busy() { left.min(POLL) } else { left };
            if let Ok(event) = self.events.recv_timeout(nap) {
                return Some(event);
            }
            if let Some(navigation) = self.navigator.as_mut().and_then(Navigator::poll) {
                return Some(Event::Navigation(navigation));
            }
            if let Some(are_adjusted) = self.edges.as_mut().and_then(EdgesClient::poll) {
                return Some(Event::EdgesAdjusted(are_adjusted));
            }
            if left.is_zero() {
                return None;
            }
        }
    }

    fn answer(&mut self, request: Request, reply: Reply) {
        self.services.answer(request, reply);
    }

    fn navigate(&mut self, goal: Option<PoseStamped>) {
        match (&mut self.navigator, goal) {
            (Some(navigator), Some(goal)) => navigator.send(goal),
            (Some(navigator), None) => navigator.cancel(),
            (None, _) => {}
        }
    }

    fn adjust_edges(&mut self, edges: DynamicEdges) {
        if let Some(client) = &mut self.edges {
            client.send(edges);
        }
    }
}

fn context(environment: &Environment) -> anyhow::Result<Context> {
    let builder = DomainParticipantBuilder::new(environment.domain);
    let builder = match environment.range {
        Range::Subnet => builder,
        Range::Localhost => builder.with_only_networks([IpAddr::V4(Ipv4Addr::LOCALHOST)]),
        Range::Off => builder.with_only_networks(Vec::<IpAddr>::new()).same_host_loopback(false),
    };
    Ok(Context::from_domain_participant(builder.build()?)?)
}

/// Opens the publishers of a node.
fn publishers(endpoints: &mut Endpoints, wiring: &Wiring) -> anyhow::Result<Publishers> {
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

fn profile(quality: &Quality, when_full: WhenFull) -> QosProfile {
    QosProfile {
        reliability: match quality.is_reliable {
            true => Reliability::Reliable { when_full },
            false => Reliability::BestEffort,
        },
        durability: if quality.is_latched { Durability::TransientLocal } else { Durability::Volatile },
        history: History::KeepLast { depth: quality.depth },
        ..QosProfile::subscription_default()
    }
}

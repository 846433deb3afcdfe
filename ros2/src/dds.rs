//! The connection by DDS: the only part that knows the client library.

/// Calls a macro with the variant of [`Message`] that a topic carries.
macro_rules! by_type {
    ($topic:expr, $open:ident) => {
        match $topic {
            Topic::Scan => $open!(Scan),
            Topic::Odometry | Topic::GroundTruth => $open!(Odometry),
            Topic::Transforms | Topic::StaticTransforms => $open!(Transforms),
            Topic::Clock => $open!(Clock),
            Topic::Velocity => $open!(Twist),
            Topic::StampedVelocity => $open!(TwistStamped),
            Topic::Resume => $open!(Bool),
            Topic::Map | Topic::ChangeMap | Topic::PredictedMap | Topic::RateMap => $open!(Grid),
            Topic::SpeedMask | Topic::KeepoutMask => $open!(Grid),
            Topic::SpeedFilterInfo | Topic::KeepoutFilterInfo => $open!(FilterInfo),
            Topic::EstimatedPose => $open!(PoseWithCovariance),
            Topic::Diagnostics => $open!(Diagnostics),
            Topic::MapUpdates => $open!(GridUpdate),
            Topic::Markers => $open!(Markers),
            Topic::GoalPose => $open!(Pose),
        }
    };
}

mod actions;
mod discovery;
mod publishers;
mod subscribers;

use crate::environment::{Environment, Range, Services};
use crate::link::{Answer, Event, Link, Request, Wiring};
use crate::message::{Message, PoseStamped, Quality, Topic};
use crate::value::Value;
use actions::Navigator;
use anyhow::{Context as _, anyhow};
use discovery::Discovery;
use futures::executor::block_on;
use publishers::Publishers;
use ros2_client::dds::rustdds::DomainParticipantBuilder;
use ros2_client::qos::{Durability, History, QosProfile, Reliability, WhenFull};
use ros2_client::{
    Context, Name, Node, NodeName, NodeOptions, ParameterValue, RmwRequestId, Server, ServiceMapping,
    ServiceTypeName,
};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, VecDeque};
use std::net::{IpAddr, Ipv4Addr};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender, SyncSender};
use std::time::{Duration, Instant};

/// How long a message that must not be lost waits if a subscriber does not keep up.
const WAIT: Duration = Duration::from_millis(20);
/// The time between two looks at what Nav2 answers.
const POLL: Duration = Duration::from_millis(20);
/// Events that wait for the node. If there are more, messages are lost on the network, as their QoS has it.
const MAX_EVENTS: usize = 4096;
/// Requests that wait for an answer; more are forgotten.
const MAX_REQUESTS: usize = 100;

/// The request of `std_srvs/Trigger`: a message without a field has this one on the wire.
#[derive(Clone, Debug, Deserialize, Serialize)]
struct TriggerRequest {
    structure_needs_at_least_one_member: u8,
}

/// The response of `std_srvs/Trigger`.
#[derive(Clone, Debug, Deserialize, Serialize)]
struct TriggerResponse {
    success: bool,
    message: String,
}

impl ros2_client::Message for TriggerRequest {}
impl ros2_client::Message for TriggerResponse {}

type SaveState = Server<TriggerRequest, TriggerResponse>;

/// A node on the network.
pub struct DdsLink {
    events: Receiver<Event>,
    names: BTreeMap<Topic, String>,
    publishers: Publishers,
    discovery: Discovery,
    problems: VecDeque<String>,
    navigator: Option<Navigator>,
    save_state: Option<Arc<SaveState>>,
    requests: BTreeMap<u64, RmwRequestId>,
    coming: Receiver<RmwRequestId>,
    next_request: u64,
    /// Ends the node when it is dropped.
    _node: Node,
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
        let mut node = context.new_node(name, options(wiring))?;
        let mapping = match environment.services {
            Services::Enhanced => ServiceMapping::Enhanced,
            Services::Cyclone => ServiceMapping::Cyclone,
        };
        let publishers = Publishers::new(&mut node, wiring)?;
        let navigator = wiring.navigate_to_pose.as_deref();
        let navigator = navigator.map(|name| Navigator::new(&mut node, name, mapping)).transpose()?;
        let (to, events) = mpsc::sync_channel(MAX_EVENTS);
        let (requests, coming) = mpsc::channel();
        let save_state = wiring.save_state.as_deref();
        let save_state = save_state.map(|name| save_state_server(&mut node, name, mapping)).transpose()?;
        subscribers::start(&mut node, &context, wiring, publishers.ids(), &to)?;
        if let Some(server) = &save_state {
            listen(server.clone(), requests, to)?;
        }
        let spinner = node.spinner()?;
        std::thread::Builder::new().name("parameters".to_owned()).spawn(move || {
            // It ends with the node; parameters are then not answered any longer.
            block_on(spinner.spin()).ok();
        })?;
        Ok(Self {
            events,
            names: wiring.published.iter().map(|(topic, name, _)| (*topic, name.clone())).collect(),
            publishers,
            discovery: Discovery::new(context, wiring),
            problems: VecDeque::new(),
            navigator,
            save_state,
            requests: BTreeMap::new(),
            coming,
            next_request: 0,
            _node: node,
        })
    }

    /// Gives a request a number, for the one who answers it.
    fn numbered(&mut self, event: Event) -> Event {
        let Event::SaveState(_) = event else { return event };
        let Ok(id) = self.coming.try_recv() else { return Event::Problem("a request was lost".to_owned()) };
        while self.requests.len() >= MAX_REQUESTS {
            self.requests.pop_first();
        }
        self.next_request += 1;
        self.requests.insert(self.next_request, id);
        Event::SaveState(Request(self.next_request))
    }
}

impl Link for DdsLink {
    fn send(&mut self, topic: Topic, message: Message) -> bool {
        self.publishers.send(topic, message)
    }

    fn name(&self, topic: Topic) -> &str {
        self.names.get(&topic).map_or(topic.default_name(), String::as_str)
    }

    fn receive(&mut self, patience: Duration) -> Option<Event> {
        self.problems.extend(self.publishers.take_problem());
        self.problems.extend(self.discovery.problems());
        if let Some(problem) = self.problems.pop_front() {
            return Some(Event::Problem(problem));
        }
        let end = Instant::now() + patience;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let nap =
                if self.navigator.as_ref().is_some_and(Navigator::is_busy) { left.min(POLL) } else { left };
            if let Ok(event) = self.events.recv_timeout(nap) {
                return Some(self.numbered(event));
            }
            if let Some(navigation) = self.navigator.as_mut().and_then(Navigator::poll) {
                return Some(Event::Navigation(navigation));
            }
            if left.is_zero() {
                return None;
            }
        }
    }

    fn answer(&mut self, Request(number): Request, Answer { is_done, text }: Answer) {
        let Some((server, id)) = self.save_state.as_ref().zip(self.requests.remove(&number)) else { return };
        // The one who asked may be gone.
        server.send_response(id, TriggerResponse { success: is_done, message: text }).ok();
    }

    fn navigate(&mut self, goal: Option<PoseStamped>) {
        match (&mut self.navigator, goal) {
            (Some(navigator), Some(goal)) => navigator.send(goal),
            (Some(navigator), None) => navigator.cancel(),
            (None, _) => {}
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

/// The parameters can be read, and not be changed while the node runs.
fn options(wiring: &Wiring) -> NodeOptions {
    let mut options = NodeOptions::new().enable_rosout(false);
    let declared = wiring.parameters.iter().map(|(name, value)| (name.clone(), on_wire(value)));
    let declared: BTreeMap<String, ParameterValue> = declared.collect();
    for (name, value) in &declared {
        options = options.declare_parameter(name, value.clone());
    }
    options.parameter_validator(Box::new(move |name, value| {
        let is_same = declared.get(name) == Some(value);
        is_same.then_some(()).ok_or_else(|| "the parameters of this node are set when it starts".to_owned())
    }))
}

fn on_wire(value: &Value) -> ParameterValue {
    match value {
        Value::Bool(value) => ParameterValue::Boolean(*value),
        Value::Integer(value) => ParameterValue::Integer(*value),
        Value::Float(value) => ParameterValue::Double(*value),
        Value::Text(value) => ParameterValue::String(value.clone()),
    }
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

fn save_state_server(node: &mut Node, name: &str, mapping: ServiceMapping) -> anyhow::Result<Arc<SaveState>> {
    let (service, quality) =
        (ServiceTypeName::new("std_srvs", "Trigger"), profile(&Quality::DEFAULT, WhenFull::Wait(WAIT)));
    let name = Name::parse(name)?;
    Ok(Arc::new(node.create_server(mapping, &name, &service, quality.clone(), quality)?))
}

/// Waits for requests in a thread of its own, which ends with the program.
fn listen(
    server: Arc<SaveState>,
    requests: Sender<RmwRequestId>,
    to: SyncSender<Event>,
) -> anyhow::Result<()> {
    let wait = move || {
        loop {
            let event = match block_on(server.async_receive_request()) {
                Ok((id, _)) if requests.send(id).is_ok() => Event::SaveState(Request(0)),
                Ok(_) => return,
                Err(why) => Event::Problem(format!("a request to save the state is damaged: {why}")),
            };
            if to.send(event).is_err() {
                return;
            }
        }
    };
    let thread = std::thread::Builder::new().name("save_state".to_owned()).spawn(wait);
    thread.map(drop).map_err(|why| anyhow!("cannot start a thread: {why}"))
}

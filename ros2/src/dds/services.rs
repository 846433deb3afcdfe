//! The services of the node: a thread waits for all requests, and another one sends the answers.

use super::others::{Endpoints, Others};
use super::{WAIT, profile};
use crate::link::{Event, Request};
use crate::message::Quality;
use crate::service::wire;
use crate::service::{Call, Reply, Service};
use futures::executor::block_on_stream;
use futures::stream::{BoxStream, StreamExt, select_all, unfold};
use ros2_client::dds::rustdds::{RepresentationIdentifier, serialization::to_writer_with_rep_id};
use ros2_client::qos::WhenFull;
use ros2_client::{Message, Name, Node, RmwRequestId, Server, ServiceMapping, ServiceTypeName};
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, SyncSender};
use std::time::{Duration, Instant};

/// An answer waits at most this long until the client can hear it.
const PATIENCE: Duration = Duration::from_secs(2);
/// The time between two looks at who can hear an answer, while one waits.
const POLL: Duration = Duration::from_millis(2);

impl Message for wire::Nothing {}
impl Message for wire::Deserialize {}
impl Message for wire::Labelled {}
impl Message for wire::Prefixes {}
impl Message for wire::Parameter {}
impl Message for Reply {}

/// Sends an answer of one type.
type Send = Box<dyn Fn(Request, Reply) + std::marker::Send>;

/// The services of a node.
pub(super) struct Services {
    answers: Sender<(Request, Reply)>,
    problems: SyncSender<Event>,
}

impl Services {
    /// Opens the services; requests become events.
    pub(super) fn open(
        endpoints: &mut Endpoints,
        others: Others,
        services: &[(Service, String)],
        mapping: ServiceMapping,
        to: &SyncSender<Event>,
    ) -> anyhow::Result<Self> {
        let (mut streams, mut senders) = (Vec::new(), BTreeMap::new());
        for (service, name) in services {
            let (stream, send) = server(endpoints.node(), *service, name, mapping)?;
            streams.push(stream);
            senders.insert(*service, (format!("rr{name}Reply"), send));
        }
        let (answers, coming) = mpsc::channel();
        let (requests, problems) = (to.clone(), to.clone());
        std::thread::Builder::new().name("requests".to_owned()).spawn(move || {
            for event in block_on_stream(select_all(streams)) {
                if requests.send(event).is_err() {
                    return; // The node has ended.
                }
            }
        })?;
        std::thread::Builder::new().name("answers".to_owned()).spawn(move || {
            answer_all(&coming, &senders, &others);
        })?;
        Ok(Self { answers, problems })
    }

    /// Answers a request as soon as the client can hear it.
    pub(super) fn answer(&self, request: Request, reply: Reply) {
        let (reply, is_cut) = fitting(reply);
        if is_cut {
            let name = request.service.default_name();
            let text = format!(
                "an answer of `{name}` is too long for one datagram: ask for fewer parameters at once"
            );
            self.problems.try_send(Event::Problem(text)).ok();
        }
        // The thread ends with the program.
        self.answers.send((request, reply)).ok();
    }
}

/// Sends answers. The reader of a client that has just come is often discovered after its request: an answer that is sent before is
/// not for this reader, since answers are volatile, and the client waits until it gives up.
fn answer_all(
    coming: &Receiver<(Request, Reply)>,
    senders: &BTreeMap<Service, (String, Send)>,
    others: &Others,
) {
    // Answers that their clients cannot hear yet, and until when they wait.
    let mut waiting: Vec<(Request, Reply, Instant)> = Vec::new();
    loop {
        let came = match waiting.is_empty() {
            true => coming.recv().map_err(RecvTimeoutError::from),
            false => coming.recv_timeout(POLL),
        };
        match came {
            Ok((request, reply)) => waiting.push((request, reply, Instant::now() + PATIENCE)),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        waiting.retain(|(request, reply, until)| {
            let Some((topic, send)) = senders.get(&request.service) else { return false };
            let is_due = others.has(topic, &request.client) || Instant::now() >= *until;
            if is_due {
                send(*request, reply.clone());
            }
            !is_due
        });
    }
}

/// The requests of a service, and what sends its answers.
fn server(
    node: &mut Node,
    service: Service,
    name: &str,
    mapping: ServiceMapping,
) -> anyhow::Result<(BoxStream<'static, Event>, Send)> {
    let at = (service, name, mapping);
    match service {
        Service::SaveState
        | Service::GetState
        | Service::GetAvailableStates
        | Service::GetAvailableTransitions
        | Service::GetTransitionGraph => serve(node, at, |_: wire::Nothing| Call::Nothing),
        Service::SaveMap | Service::SerializeMap => serve(node, at, Call::Name),
        Service::DeserializeMap => serve(node, at, Call::Deserialize),
        Service::ChangeState => serve(node, at, Call::Transition),
        Service::GetParameters | Service::GetParameterTypes | Service::DescribeParameters => {
            serve(node, at, Call::Names)
        }
        Service::SetParameters | Service::SetParametersAtomically => serve(node, at, Call::Parameters),
        Service::ListParameters => serve(node, at, Call::Prefixes),
    }
}

fn serve<Q: Message + Clone + std::marker::Send + Sync + 'static>(
    node: &mut Node,
    (service, name, mapping): (Service, &str, ServiceMapping),
    call: fn(Q) -> Call,
) -> anyhow::Result<(BoxStream<'static, Event>, Send)> {
    let quality = profile(&Quality::DEFAULT, WhenFull::Wait(WAIT));
    let (package, kind) = service.type_name();
    let (kind, name) = (ServiceTypeName::new(package, kind), Name::parse(name)?);
    let server: Server<Q, Reply> = node.create_server(mapping, &name, &kind, quality.clone(), quality)?;
    let server = Arc::new(server);
    let sender = server.clone();
    let stream = unfold(server, move |server| async move {
        let event = match server.async_receive_request().await {
            Ok((id, request)) => {
                let (client, number) = (id.writer_gid.to_bytes16(), id.sequence_number);
                Event::Call(Request { service, client, number }, call(request))
            }
            Err(why) => {
                let name = service.default_name();
                Event::Problem(format!("a request of the service `{name}` is damaged: {why}"))
            }
        };
        Some((event, server))
    });
    let send = move |Request { client, number, .. }: Request, reply| {
        let id = RmwRequestId { writer_gid: client.into(), sequence_number: number };
        // The one who asked may be gone.
        sender.send_response(id, reply).ok();
    };
    Ok((stream.boxed(), Box::new(send)))
}

/// The longest answer, bytes: a datagram of 1452 bytes without the headers of RTPS.
const MAX_REPLY: usize = 1200;

/// The answer, or a shorter one that fits in one datagram, and whether something that was asked for is missing.
///
/// The library writes fragments of an answer with one byte too many before the identity of the request (rustdds 0.15.1, `DataFrag`: the
/// tag of an `Option`). No client can read them, and a build with debug assertions ends the thread of the network. Other messages
/// have no such identity, and are sent in fragments as they should.
fn fitting(reply: Reply) -> (Reply, bool) {
    match reply {
        Reply::Values(values) if length(&values) > MAX_REPLY => (Reply::Values(Vec::new()), true),
        Reply::Descriptions(mut all) if length(&all) > MAX_REPLY => {
            for one in &mut all {
                one.description.clear();
                one.additional_constraints.clear();
            }
            match length(&all) > MAX_REPLY {
                true => (Reply::Descriptions(Vec::new()), true),
                false => (Reply::Descriptions(all), false),
            }
        }
        reply => (reply, false),
    }
}

/// The number of bytes of a message; 0 if it cannot be written, which is noticed where it is.
fn length(message: &impl Serialize) -> usize {
    let mut bytes = Vec::new();
    to_writer_with_rep_id(&mut bytes, message, RepresentationIdentifier::CDR_LE).map_or(0, |()| bytes.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::wire::{Description, ParameterValue};
    use crate::value::Value;

    #[test]
    fn an_answer_that_is_too_long_is_empty() {
        let values = |count| Reply::Values(vec![ParameterValue::from(&Value::Float(1.0)); count]);
        assert_eq!(fitting(values(20)), (values(20), false));
        assert_eq!(fitting(values(30)), (Reply::Values(Vec::new()), true));
        let text = "What it means. ".repeat(10);
        let described =
            |count| vec![Description { description: text.clone(), ..Description::default() }; count];
        assert_eq!(fitting(Reply::Descriptions(described(5))), (Reply::Descriptions(described(5)), false));
        let (Reply::Descriptions(cut), false) = fitting(Reply::Descriptions(described(15))) else { panic!() };
        assert!(cut.len() == 15 && cut.iter().all(|one| one.description.is_empty()));
    }
}

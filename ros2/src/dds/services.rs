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
        | Service::GetPatience
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

/// The longest answer, bytes: a datagram on a link with an MTU of 1500 without the headers of IP and RTPS.
const MAX_REPLY: usize = 1200;
/// The texts of an answer that is too long are cut to these lengths in turn, letters, until it fits.
const CUTS: [usize; 3] = [300, 60, 0];

/// The answer, or a shorter one that fits in one datagram, and whether what was asked for is missing.
///
/// The library writes fragments of an answer with one byte too many before the identity of the request (rustdds 0.15.1, `DataFrag`: the
/// tag of an `Option`). No client can read them, and a build with debug assertions ends the thread of the network. Other messages
/// have no such identity, and are sent in fragments as they should.
fn fitting(mut reply: Reply) -> (Reply, bool) {
    for cut in CUTS {
        if length(&reply) <= MAX_REPLY {
            return (reply, false);
        }
        for text in reply.texts_mut() {
            if let Some((end, _)) = text.char_indices().nth(cut) {
                text.truncate(end);
                text.push_str(if cut > 0 { " …" } else { "" });
            }
        }
    }
    let fits = length(&reply) <= MAX_REPLY;
    (if fits { reply } else { reply.emptied() }, !fits)
}

/// The number of bytes of a message; 0 if it cannot be written, which is noticed where it is.
fn length(message: &impl Serialize) -> usize {
    let mut bytes = Vec::new();
    to_writer_with_rep_id(&mut bytes, message, RepresentationIdentifier::CDR_LE).map_or(0, |()| bytes.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::wire::{Description, Labelled, Listed, ParameterValue, SetResult, Trigger};
    use crate::value::Value;

    #[test]
    fn every_answer_fits_in_one_datagram() {
        let long = || "a long sentence, ".repeat(5000);
        let label = Labelled { id: 1, label: long() };
        let values = |count| Reply::Values(vec![ParameterValue::from(&Value::Float(1.0)); count]);
        let result = |reason: String| SetResult { successful: false, reason };
        let described = |count, text: &str| {
            let one = Description { description: text.to_owned(), ..Description::default() };
            Reply::Descriptions(vec![one; count])
        };
        for count in [0, 1, 3, 20, 100, 3000] {
            for reply in [
                values(count),
                Reply::Types(vec![3; count]),
                Reply::States(vec![label.clone(); count]),
                Reply::Results(vec![result(long()); count]),
                Reply::Result(result("x".repeat(count))),
                Reply::Trigger(Trigger { is_done: true, text: "\u{1f6aa}".repeat(count) }),
                Reply::Listed(Listed { names: vec!["name".to_owned(); count], prefixes: vec![long()] }),
                described(count, &long()),
            ] {
                let fits = length(&reply) <= MAX_REPLY;
                let (sent, is_missing) = fitting(reply.clone());
                assert!(length(&sent) <= MAX_REPLY, "{count} {reply:?}");
                assert!(!fits || sent == reply && !is_missing);
                assert_eq!(std::mem::discriminant(&sent), std::mem::discriminant(&reply));
            }
        }
        // What was asked for is there as long as there is room: three unknown parameters, and twenty descriptions.
        let (Reply::Results(three), false) = fitting(Reply::Results(vec![result(long()); 3])) else {
            panic!()
        };
        assert!(three.len() == 3 && three[2].reason.starts_with("a long sentence, a long"), "{three:?}");
        let (Reply::Descriptions(cut), false) = fitting(described(20, &long())) else { panic!() };
        assert_eq!(cut.len(), 20);
        assert_eq!(fitting(values(30)), (values(0), true));
    }
}

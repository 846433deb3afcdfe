//! A live viewer of a run: started here, or already running.

use rerun::external::re_grpc_client::write::ClientConnectionState;
use rerun::external::re_uri::ProxyUri;
use rerun::log::LogMsg;
use rerun::sink::{GrpcSink, LogSink};
use std::fmt::Display;
use std::io::{self, ErrorKind};
use std::net::{TcpStream, ToSocketAddrs};
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// A viewer that shows the run while it goes on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Live {
    /// The viewer on this machine; it is started unless it already runs.
    Spawn,
    /// A running viewer at an address: `rerun+http://HOST:PORT/proxy`, or `HOST:PORT` for short.
    Connect(String),
}

impl Live {
    /// The running viewer at `address`.
    ///
    /// # Errors
    ///
    /// When the address is invalid. Whether a viewer runs there is not checked yet.
    pub fn at(address: &str) -> Result<Self, LiveError> {
        parse(address).map(|_| Self::Connect(address.into()))
    }
}

/// The error for a viewer that cannot show the run.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct LiveError(String);

impl LiveError {
    fn unreachable(uri: &ProxyUri, why: impl Display) -> Self {
        Self(format!("no viewer answers at {uri}: {why}; start one there with `rerun`"))
    }
}

/// The maximum time until a viewer has started: the first start from a slow disk takes several seconds.
const START_TIMEOUT: Duration = Duration::from_secs(20);
/// If a viewer accepts nothing for this time, the connection counts as lost.
const STALL_TIMEOUT: Duration = Duration::from_secs(5);
/// The number of messages that may wait for a viewer.
const QUEUE: usize = 256;
/// The program of the viewer.
const PROGRAM: &str = "rerun";

/// The connection to one viewer. A viewer that was closed, or that accepts nothing, counts as lost: it never delays
/// a run by more than [`STALL_TIMEOUT`].
pub(super) struct LiveFeed {
    pub(super) address: String,
    state: State,
}

enum State {
    Open { queue: SyncSender<LogMsg>, delivered: Receiver<bool> },
    Lost,
    Closed,
}

impl LiveFeed {
    /// Connects to `live`.
    pub(super) fn open(live: &Live) -> Result<Self, LiveError> {
        let uri = match live {
            Live::Connect(address) => parse(address)?,
            Live::Spawn => {
                let uri = parse(rerun::DEFAULT_CONNECT_URL)?;
                if reach(&uri).is_err() {
                    spawn(PROGRAM, &uri)?;
                }
                uri
            }
        };
        let sink = connect(&uri)?;
        let (queue, messages) = sync_channel(QUEUE);
        let (report, delivered) = channel();
        thread::spawn(move || report.send(deliver(sink, messages)));
        Ok(Self { address: uri.to_string(), state: State::Open { queue, delivered } })
    }

    pub(super) fn send(&mut self, message: &LogMsg) {
        let State::Open { queue, .. } = &self.state else { return };
        let mut waiting = Some(message.clone());
        let is_sent = wait_for(STALL_TIMEOUT, || match queue.try_send(waiting.take()?) {
            Ok(()) => Some(true),
            Err(TrySendError::Disconnected(_)) => Some(false),
            Err(TrySendError::Full(message)) => {
                waiting = Some(message);
                None
            }
        });
        if is_sent != Some(true) {
            self.state = State::Lost;
        }
    }

    /// Whether the viewer went away.
    pub(super) fn is_lost(&self) -> bool {
        matches!(self.state, State::Lost)
    }

    /// Waits until everything is delivered, or the viewer is lost.
    pub(super) fn close(&mut self) {
        if let State::Open { queue, delivered } = std::mem::replace(&mut self.state, State::Closed) {
            drop(queue);
            if delivered.recv_timeout(STALL_TIMEOUT) != Ok(true) {
                self.state = State::Lost;
            }
        }
    }
}

/// Sends all messages until the queue is closed. Returns whether all of them were sent.
fn deliver(sink: GrpcSink, messages: Receiver<LogMsg>) -> bool {
    for message in messages {
        sink.send(message);
        if matches!(sink.status(), ClientConnectionState::Disconnected(_)) {
            return false;
        }
    }
    sink.flush_blocking(STALL_TIMEOUT).is_ok()
    // Dropping the sink waits for the viewer.
}

fn parse(address: &str) -> Result<ProxyUri, LiveError> {
    let long = if address.contains("://") { address.into() } else { format!("rerun+http://{address}/proxy") };
    long.parse().map_err(|why| {
        let valid = "rerun+http://127.0.0.1:9876/proxy";
        LiveError(format!("`{address}` is not the address of a viewer: {why}; a valid address is {valid}"))
    })
}

/// The first value of `poll` within `timeout`.
fn wait_for<T>(timeout: Duration, mut poll: impl FnMut() -> Option<T>) -> Option<T> {
    let deadline = Instant::now() + timeout;
    loop {
        let value = poll();
        if value.is_some() || Instant::now() >= deadline {
            return value;
        }
        thread::sleep(Duration::from_millis(5));
    }
}

fn connect(uri: &ProxyUri) -> Result<GrpcSink, LiveError> {
    reach(uri).map_err(|error| LiveError::unreachable(uri, error))?;
    let sink = GrpcSink::new(uri.clone());
    let is_connected = wait_for(ANSWER_TIMEOUT, || match sink.status() {
        ClientConnectionState::Connected => Some(true),
        ClientConnectionState::Connecting { .. } => None,
        ClientConnectionState::Disconnected(_) => Some(false),
    });
    if is_connected == Some(true) {
        return Ok(sink);
    }
    thread::spawn(move || drop(sink)); // waits for the viewer a while longer
    Err(LiveError::unreachable(uri, "what listens there is not a viewer"))
}

/// Starts the viewer and waits until it answers.
fn spawn(program: &str, uri: &ProxyUri) -> Result<(), LiveError> {
    let mut command = Command::new(program);
    command.arg("--port").arg(uri.origin.port.to_string()).arg("--hide-welcome-screen");
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    #[cfg(unix)] // Ctrl-C ends the run, and the viewer stays open
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut viewer = command.spawn().map_err(|why| {
        LiveError(if why.kind() == io::ErrorKind::NotFound {
            let version = rerun::build_info().version;
            format!(
                "cannot start the viewer: there is no program `{program}`; install it with \
                 `pip install rerun-sdk=={version}`"
            )
        } else {
            format!("cannot start the viewer `{program}`: {why}")
        })
    })?;
    let started = wait_for(START_TIMEOUT, || match (reach(uri), viewer.try_wait()) {
        (Ok(()), _) => Some(Ok(())),
        // A launcher may end with success while the viewer that it launched goes on.
        (_, Ok(Some(status))) if !status.success() => Some(Err(LiveError(format!(
            "the viewer `{program}` ended at once ({status}); run it by itself to see why"
        )))),
        _ => None,
    });
    let timeout = || format!("it did not start within {} s", START_TIMEOUT.as_secs());
    started.unwrap_or_else(|| Err(LiveError::unreachable(uri, timeout())))
}

/// The maximum time until a running viewer answers.
const ANSWER_TIMEOUT: Duration = Duration::from_millis(1500);

/// Checks that the server at `uri` accepts connections: the SDK tries to connect without end.
fn reach(uri: &ProxyUri) -> io::Result<()> {
    let (host, port) = (uri.origin.host.to_string(), uri.origin.port);
    let (report, outcome) = channel();
    // In a thread, because the lookup of a name has no timeout of its own.
    thread::spawn(move || {
        let none = Err(io::Error::new(ErrorKind::NotFound, "the name has no address"));
        let addresses = (host.trim_matches(['[', ']']), port).to_socket_addrs();
        let reached = addresses.and_then(|addresses| {
            addresses.fold(none, |reached, address| {
                reached.or_else(|_| TcpStream::connect_timeout(&address, ANSWER_TIMEOUT).map(drop))
            })
        });
        report.send(reached)
    });
    outcome.recv_timeout(ANSWER_TIMEOUT).unwrap_or_else(|_| Err(ErrorKind::TimedOut.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;
    use std::net::TcpListener;

    fn listen() -> TcpListener {
        TcpListener::bind("127.0.0.1:0").unwrap()
    }

    fn address(server: &TcpListener) -> String {
        server.local_addr().unwrap().to_string()
    }

    fn fails(address: &str) -> String {
        LiveFeed::open(&Live::Connect(address.into())).err().unwrap().to_string()
    }

    #[test]
    fn an_invalid_address_is_refused() {
        for address in ["", "rerun+http://", "ftp://127.0.0.1:1/proxy", "127.0.0.1:99999", "a viewer"] {
            let message = fails(address);
            assert!(message.contains("is not the address of a viewer"), "{address}: {message}");
            assert!(message.contains("rerun+http://127.0.0.1:9876/proxy"), "{message}");
        }
    }

    #[test]
    fn a_viewer_that_cannot_show_the_run_is_one_sentence() {
        let free = address(&listen());
        let uri = parse(&free).unwrap();
        let spawns = |program: &str| spawn(program, &uri).unwrap_err().to_string();
        for (message, says) in [
            (fails(&free), format!("no viewer answers at rerun+http://{free}/proxy: ")),
            (spawns("no-such-viewer-0"), "there is no program `no-such-viewer-0`".to_owned()),
            #[cfg(unix)]
            (spawns("false"), "ended at once".to_owned()),
        ] {
            assert!(message.contains(&says) && !message.contains('\n'), "{message}");
        }
    }

    /// A connection counts as open as soon as it is accepted: what is not a viewer shows later, and keeps no run from its end.
    #[test]
    fn another_program_is_a_lost_viewer() {
        for answer in ["", "HTTP/1.1 400 Bad Request\r\n\r\n"] {
            let server = listen();
            let at = address(&server);
            std::thread::spawn(move || {
                let answered = server.incoming().flatten().map(|mut client| {
                    client.write_all(answer.as_bytes()).unwrap();
                    client
                });
                answered.collect::<Vec<_>>() // they stay open
            });
            match LiveFeed::open(&Live::Connect(at)) {
                Ok(mut feed) => {
                    feed.close();
                    assert!(feed.is_lost(), "{answer:?}");
                }
                Err(error) => {
                    assert!(error.to_string().contains("what listens there is not a viewer"), "{error}")
                }
            }
        }
    }
}

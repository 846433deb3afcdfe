//! A live viewer of a run: started here, or already running.

use rerun::external::re_grpc_client::write::ClientConnectionState;
use rerun::external::re_uri::ProxyUri;
use rerun::log::LogMsg;
use rerun::sink::{GrpcSink, LogSink};
use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, channel, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// A viewer that shows the run while it goes on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Live {
    /// The viewer on this machine; it is started unless it runs already.
    Spawn,
    /// A running viewer at an address: `rerun+http://HOST:PORT/proxy`, or `HOST:PORT` for short.
    Connect(String),
}

impl Live {
    /// The running viewer at `address`.
    ///
    /// # Errors
    ///
    /// When the address is invalid. No viewer has to run there yet.
    pub fn at(address: &str) -> Result<Self, LiveError> {
        parse(address).map(|_| Self::Connect(address.into()))
    }
}

/// Why a viewer cannot show the run.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    /// There is no viewer to start.
    #[error(
        "cannot start the viewer: there is no program `{program}`; install it with \
         `pip install rerun-sdk=={version}`"
    )]
    Missing {
        /// The program that was looked for.
        program: String,
        /// The version that fits.
        version: String,
    },
    /// The viewer cannot be started.
    #[error("cannot start the viewer `{program}`: {why}")]
    Start {
        /// The program that was started.
        program: String,
        /// The reason.
        why: io::Error,
    },
    /// The viewer ended at once.
    #[error("the viewer `{program}` ended at once ({status}); run it by itself to see why")]
    Ended {
        /// The program that was started.
        program: String,
        /// Its exit status.
        status: std::process::ExitStatus,
    },
    /// The address is invalid.
    #[error(
        "`{address}` is not the address of a viewer: {why}; a valid address is rerun+http://127.0.0.1:9876/proxy"
    )]
    Address {
        /// The given text.
        address: String,
        /// What is invalid.
        why: String,
    },
    /// No viewer runs at the address.
    #[error("no viewer answers at {address}: {why}; start one there with `rerun`")]
    Unreachable {
        /// The address.
        address: String,
        /// What happened instead.
        why: String,
    },
}

/// How long a running viewer may take to answer.
const ANSWER_TIMEOUT: Duration = Duration::from_millis(1500);
/// How long a viewer may take to start: the first start on a slow disk takes several seconds.
const START_TIMEOUT: Duration = Duration::from_secs(20);
/// How long a viewer may accept nothing before it counts as lost.
const STALL_TIMEOUT: Duration = Duration::from_secs(5);
/// The number of messages that may wait for a viewer.
const QUEUE: usize = 256;
/// The program of the viewer, unless the options name another.
pub(super) const PROGRAM: &str = "rerun";

/// The connection to one viewer. A viewer that goes away, or accepts nothing, is lost: it never delays a run
/// by more than [`STALL_TIMEOUT`].
pub(super) struct LiveFeed {
    address: String,
    state: Mutex<State>,
}

enum State {
    Open { queue: SyncSender<LogMsg>, delivered: Receiver<bool> },
    Lost,
    Closed,
}

impl LiveFeed {
    /// Connects to `live`; `program` is the viewer to start.
    pub(super) fn open(live: &Live, program: &str) -> Result<Self, LiveError> {
        let uri = match live {
            Live::Connect(address) => parse(address)?,
            Live::Spawn => {
                let uri = parse(rerun::DEFAULT_CONNECT_URL)?;
                if reach(&uri).is_err() {
                    spawn(program, &uri)?;
                }
                uri
            }
        };
        let sink = connect(&uri)?;
        let (queue, messages) = sync_channel(QUEUE);
        let (report, delivered) = channel();
        thread::spawn(move || report.send(deliver(sink, messages)));
        Ok(Self { address: uri.to_string(), state: State::Open { queue, delivered }.into() })
    }

    pub(super) fn address(&self) -> &str {
        &self.address
    }

    pub(super) fn send(&self, message: &LogMsg) {
        let mut state = self.state();
        let State::Open { queue, .. } = &*state else { return };
        let deadline = Instant::now() + STALL_TIMEOUT;
        let mut message = message.clone();
        loop {
            match queue.try_send(message) {
                Ok(()) => return,
                Err(TrySendError::Full(back)) if Instant::now() < deadline => message = back,
                Err(_) => break,
            }
            thread::sleep(Duration::from_millis(2));
        }
        *state = State::Lost;
    }

    /// Whether the viewer went away.
    pub(super) fn is_lost(&self) -> bool {
        matches!(*self.state(), State::Lost)
    }

    /// Waits until everything is delivered, or the viewer is lost.
    pub(super) fn close(&self) {
        let mut state = self.state();
        let State::Open { queue, delivered } = std::mem::replace(&mut *state, State::Closed) else {
            return;
        };
        drop(queue);
        if delivered.recv_timeout(STALL_TIMEOUT) != Ok(true) {
            *state = State::Lost;
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
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
    long.parse().map_err(|error| LiveError::Address { address: address.into(), why: format!("{error}") })
}

/// Checks that a server listens at `uri`. The SDK would try for ever.
fn reach(uri: &ProxyUri) -> io::Result<()> {
    let (host, port) = (uri.origin.host.to_string(), uri.origin.port);
    let (report, outcome) = channel();
    // In a thread, because the lookup of a name has no timeout of its own.
    thread::spawn(move || {
        let host = host.trim_matches(['[', ']']);
        let reached = (host, port).to_socket_addrs().and_then(|addresses| {
            let mut reached = Err(io::Error::new(io::ErrorKind::NotFound, "the name has no address"));
            for address in addresses {
                reached = TcpStream::connect_timeout(&address, ANSWER_TIMEOUT).map(drop);
                if reached.is_ok() {
                    break;
                }
            }
            reached
        });
        report.send(reached)
    });
    outcome.recv_timeout(ANSWER_TIMEOUT).unwrap_or_else(|_| Err(io::ErrorKind::TimedOut.into()))
}

fn connect(uri: &ProxyUri) -> Result<GrpcSink, LiveError> {
    let unreachable = |why: String| LiveError::Unreachable { address: uri.to_string(), why };
    reach(uri).map_err(|error| unreachable(error.to_string()))?;
    let sink = GrpcSink::new(uri.clone());
    let deadline = Instant::now() + ANSWER_TIMEOUT;
    loop {
        match sink.status() {
            ClientConnectionState::Connected => return Ok(sink),
            ClientConnectionState::Connecting { .. } if Instant::now() < deadline => {
                thread::sleep(Duration::from_millis(2));
            }
            _ => break,
        }
    }
    thread::spawn(move || drop(sink)); // waits for the viewer a while longer
    Err(unreachable("what listens there is not a viewer".into()))
}

/// Starts the viewer and waits until it listens.
fn spawn(program: &str, uri: &ProxyUri) -> Result<(), LiveError> {
    let mut command = Command::new(program);
    command.arg("--port").arg(uri.origin.port.to_string()).arg("--hide-welcome-screen");
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    #[cfg(unix)] // Ctrl-C ends the run; the viewer stays, to look at what there is
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let program = program.to_owned();
    let mut viewer = match command.spawn() {
        Ok(viewer) => viewer,
        Err(why) if why.kind() == io::ErrorKind::NotFound => {
            return Err(LiveError::Missing { program, version: rerun::build_info().version.to_string() });
        }
        Err(why) => return Err(LiveError::Start { program, why }),
    };
    let deadline = Instant::now() + START_TIMEOUT;
    while reach(uri).is_err() {
        match viewer.try_wait() {
            // A launcher may end well while the viewer that it launched goes on.
            Ok(Some(status)) if !status.success() => return Err(LiveError::Ended { program, status }),
            _ if Instant::now() > deadline => {
                let why = format!("it did not start within {} s", START_TIMEOUT.as_secs());
                return Err(LiveError::Unreachable { address: uri.to_string(), why });
            }
            _ => thread::sleep(Duration::from_millis(50)),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    fn fails(address: &str) -> String {
        LiveFeed::open(&Live::Connect(address.into()), PROGRAM).err().unwrap().to_string()
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
    fn a_missing_viewer_is_one_sentence() {
        let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let message = fails(&format!("127.0.0.1:{free}"));
        assert!(message.starts_with("no viewer answers at rerun+http://127.0.0.1:"), "{message}");
        assert!(!message.contains('\n'));
    }

    #[test]
    fn a_viewer_that_is_not_installed_is_one_sentence() {
        let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let uri = parse(&format!("127.0.0.1:{free}")).unwrap();
        let message = spawn("no-such-viewer-0", &uri).unwrap_err().to_string();
        assert!(
            message.starts_with("cannot start the viewer: there is no program `no-such-viewer-0`"),
            "{message}"
        );
    }

    #[test]
    #[cfg(unix)]
    fn a_viewer_that_ends_at_once_is_noticed() {
        let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let uri = parse(&format!("127.0.0.1:{free}")).unwrap();
        let message = spawn("false", &uri).unwrap_err().to_string();
        assert!(message.contains("ended at once"), "{message}");
    }
}

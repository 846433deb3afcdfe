//! Checks that a viewer answers at an address, before the SDK connects to it.
//!
//! The SDK tries to connect without end, and counts a connection as open as soon as it is accepted, even if the
//! server never sends a byte.

use rerun::external::re_uri::{ProxyUri, Scheme};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

/// The maximum time until a running viewer answers.
pub(super) const ANSWER_TIMEOUT: Duration = Duration::from_millis(1500);
/// The first bytes of an HTTP/2 client: the preface and an empty SETTINGS frame (RFC 9113, section 3.4).
const PREFACE: &[u8] = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\x04\0\0\0\0\0";
/// The length of the head of an HTTP/2 frame, bytes.
const FRAME_HEAD: usize = 9;
/// The type of a SETTINGS frame, the first frame that an HTTP/2 server sends.
const SETTINGS: u8 = 4;

/// Connects to the server at `uri`, without a word.
pub(super) fn reach(uri: &ProxyUri) -> io::Result<TcpStream> {
    let (host, port) = (uri.origin.host.to_string(), uri.origin.port);
    let timed_out = || ErrorKind::TimedOut.into();
    // In a thread, because the lookup of a name has no timeout of its own.
    within_timeout(timed_out, move || {
        let none = Err(io::Error::new(ErrorKind::NotFound, "the name has no address"));
        (host.trim_matches(['[', ']']), port).to_socket_addrs()?.fold(none, |reached, address| {
            reached.or_else(|_| TcpStream::connect_timeout(&address, ANSWER_TIMEOUT))
        })
    })
}

/// Checks that the server at `uri` answers as an HTTP/2 server, which a viewer is.
pub(super) fn check_answer(uri: &ProxyUri) -> io::Result<()> {
    let mut server = reach(uri)?;
    if uri.origin.scheme == Scheme::RerunHttps {
        return Ok(()); // The SDK opens an encrypted connection only after an answer.
    }
    let silent =
        || io::Error::new(ErrorKind::TimedOut, "a program accepts connections there, but does not answer");
    within_timeout(silent, move || {
        // Longer than the timeout of the check, so that the check reports its own reason.
        server.set_read_timeout(Some(2 * ANSWER_TIMEOUT))?;
        server.write_all(PREFACE)?;
        let mut head = [0; FRAME_HEAD];
        let is_http2 = server.read_exact(&mut head).is_ok() && head[3] == SETTINGS;
        is_http2
            .then_some(())
            .ok_or_else(|| io::Error::new(ErrorKind::InvalidData, "what listens there is not a viewer"))
    })
}

/// The result of `task` if it ends within [`ANSWER_TIMEOUT`], and otherwise the error of `late`.
fn within_timeout<T: Send + 'static>(
    late: impl FnOnce() -> io::Error,
    task: impl FnOnce() -> io::Result<T> + Send + 'static,
) -> io::Result<T> {
    let (report, outcome) = channel();
    thread::spawn(move || report.send(task()));
    outcome.recv_timeout(ANSWER_TIMEOUT).unwrap_or_else(|_| Err(late()))
}

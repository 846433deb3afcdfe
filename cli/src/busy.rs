//! Signs of life of work whose length is not known: a spinner in a terminal, plain lines elsewhere.

use crate::terminal::say;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressStyle};
use results::numbers::duration;
use std::io::{IsTerminal, Write, stderr};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{JoinHandle, spawn};
use std::time::{Duration, Instant};

/// The wall time between two plain lines.
const LINE_EVERY: Duration = Duration::from_secs(10);
/// The wall time between two states of the spinner.
const SPIN_EVERY: Duration = Duration::from_millis(250);

/// Work that is being done. The spinner vanishes, and the lines end, when the value is dropped.
pub struct Busy {
    _spinner: Option<ProgressBar>,
    _lines: Option<Lines>,
}

impl Busy {
    /// Work in words.
    pub fn with(what: String, is_quiet: bool) -> Self {
        match (is_quiet, stderr().is_terminal()) {
            (true, _) => Self { _spinner: None, _lines: None },
            (_, true) => Self { _spinner: Some(spinner(what, ProgressDrawTarget::stderr())), _lines: None },
            (_, false) => Self { _spinner: None, _lines: Some(Lines::to(stderr(), what, LINE_EVERY)) },
        }
    }
}

fn spinner(what: String, target: ProgressDrawTarget) -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} {msg}, {elapsed} so far");
    let style = style.unwrap_or_else(|_| ProgressStyle::default_spinner());
    let bar = ProgressBar::with_draw_target(None, target).with_style(style).with_message(what);
    bar.enable_steady_tick(SPIN_EVERY);
    bar.with_finish(ProgressFinish::AndClear)
}

/// A thread that prints a line now and then.
struct Lines {
    /// Dropped at the end of the work.
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Lines {
    fn to(mut to: impl Write + Send + 'static, what: String, every: Duration) -> Self {
        let ((end, ended), begin) = (channel(), Instant::now());
        let thread = spawn(move || {
            while ended.recv_timeout(every) == Err(RecvTimeoutError::Timeout) {
                say(&mut to, format_args!("{what}: {} so far", duration(begin.elapsed().as_secs_f64())));
            }
        });
        Self { end: Some(end), thread: Some(thread) }
    }
}

impl Drop for Lines {
    fn drop(&mut self) {
        drop(self.end.take());
        // A thread that only prints does not panic.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;

    /// Sends every text that is written to it.
    struct To(Sender<String>);

    impl Write for To {
        fn write(&mut self, text: &[u8]) -> io::Result<usize> {
            let _ = self.0.send(String::from_utf8_lossy(text).into_owned());
            Ok(text.len())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn lines_come_until_the_work_ends() {
        let (to, written) = channel();
        let lines = Lines::to(To(to), "closing loops".to_owned(), Duration::from_millis(1));
        let text: String = written.iter().take(40).collect();
        assert!(text.starts_with("closing loops: 0 s so far\nclosing loops: "), "{text}");
        drop(lines);
        // The writer was dropped with the thread: this ends.
        assert!(written.iter().collect::<String>().lines().all(|line| line.ends_with(" so far")));
    }
}

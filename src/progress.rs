//! The progress of a run: a bar in a terminal, plain lines elsewhere.

use evaluation::output::say;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fmt::Display;
use std::io::{IsTerminal, stderr};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// The wall time between two plain lines.
const LINE_EVERY: Duration = Duration::from_secs(5);
/// The wall time before the first message on simulated time.
const FIRST: Duration = Duration::from_millis(500);
/// The maximum rate at which the bar is drawn.
const BAR_HZ: u8 = 10;

/// The kind of progress of a run.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Silent,
    Bar,
    Lines,
}

/// The progress of one run in simulated time, or of many trials, which may run on any thread.
pub struct Progress {
    bar: ProgressBar,
    kind: Kind,
    start: Instant,
    /// The time of the next message.
    next: Mutex<Instant>,
}

impl Progress {
    /// A run of `duration_s` of simulated time. `is_raw`: the keyboard pilot uses the terminal.
    pub fn of_time(duration_s: f64, is_quiet: bool, is_raw: bool) -> Self {
        let template = "{msg} {wide_bar} {percent:>3} %  {eta} left";
        Self::new(duration_s.round() as u64, template, FIRST, is_quiet, is_raw)
    }

    /// A number of trials.
    pub fn of_trials(trials: usize, is_quiet: bool) -> Self {
        let template = "{pos} of {len} trials {wide_bar} {percent:>3} %  {eta} left";
        let progress = Self::new(trials as u64, template, LINE_EVERY, is_quiet, false);
        if progress.kind == Kind::Bar {
            progress.bar.enable_steady_tick(Duration::from_millis(200)); // The clock advances during long trials.
        }
        progress
    }

    fn new(length: u64, template: &str, first: Duration, is_quiet: bool, is_raw: bool) -> Self {
        let (kind, target) = match () {
            () if is_quiet => (Kind::Silent, ProgressDrawTarget::hidden()),
            () if stderr().is_terminal() && !is_raw => {
                (Kind::Bar, ProgressDrawTarget::stderr_with_hz(BAR_HZ))
            }
            () => (Kind::Lines, ProgressDrawTarget::hidden()),
        };
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::with_draw_target(Some(length), target).with_style(style);
        let start = Instant::now();
        Self { bar, kind, start, next: Mutex::new(start + first) }
    }

    /// Whether a message is due. If it is, the next message is due after `wait`.
    fn is_due(&self, wait: Duration) -> bool {
        let Ok(mut next) = self.next.lock() else { return false };
        let is_due = Instant::now() >= *next;
        if is_due {
            *next = Instant::now() + wait;
        }
        is_due
    }

    /// Shows the simulated time and the coverage so far.
    pub fn show(&self, time_s: f64, coverage: Option<f64>) {
        let wait = if self.kind == Kind::Bar { Duration::from_secs(1) / BAR_HZ.into() } else { LINE_EVERY };
        if self.kind == Kind::Silent || !self.is_due(wait) {
            return;
        }
        let speed = time_s / self.start.elapsed().as_secs_f64().max(1e-3);
        let seen = coverage.map_or(String::new(), |share| format!(", seen {:.1} %", 100.0 * share));
        let all_s = self.bar.length().unwrap_or(0);
        let line = format!("{time_s:.0} of {all_s} s, {speed:.0} x real time{seen}");
        if self.kind == Kind::Bar {
            self.bar.set_position(time_s as u64);
            self.bar.set_message(line);
        } else {
            say(stderr(), format_args!("{line}\r")); // a raw terminal needs the carriage return
        }
    }

    /// Counts one more finished trial.
    pub fn step(&self) {
        self.bar.inc(1);
        if self.kind == Kind::Lines && self.is_due(LINE_EVERY) {
            let (done, all) = (self.bar.position(), self.bar.length().unwrap_or(0));
            let left_s = self.start.elapsed().as_secs_f64() * (all as f64 / done.max(1) as f64 - 1.0);
            say(stderr(), format_args!("{done} of {all} trials, {left_s:.0} s left"));
        }
    }

    /// Prints a line to the error output, above the bar.
    pub fn say(&self, what: impl Display) {
        self.bar.suspend(|| say(stderr(), format_args!("{what}\r"))); // a raw terminal needs the carriage return
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

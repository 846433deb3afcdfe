//! The progress of a run: a bar in a terminal, plain lines elsewhere.

use evaluation::output::say;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// The wall time between two plain lines.
const LINE_EVERY: Duration = Duration::from_secs(5);
/// The time before the first message on simulated time.
const FIRST: Duration = Duration::from_millis(500);
/// The rate at which the bar is drawn, at most.
const BAR_HZ: u8 = 10;

/// What a run shows of its progress.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Silent,
    Bar,
    Lines,
}

fn bar(kind: Kind, length: u64, template: &str) -> ProgressBar {
    let target = match kind {
        Kind::Bar => ProgressDrawTarget::stderr_with_hz(BAR_HZ),
        _ => ProgressDrawTarget::hidden(),
    };
    let bar = ProgressBar::with_draw_target(Some(length), target);
    bar.set_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

fn kind(is_quiet: bool, is_raw: bool) -> Kind {
    match () {
        () if is_quiet => Kind::Silent,
        () if stderr().is_terminal() && !is_raw => Kind::Bar,
        () => Kind::Lines,
    }
}

/// The progress of one run in simulated time.
pub struct Progress {
    bar: ProgressBar,
    kind: Kind,
    start: Instant,
    duration_s: f64,
    next: Instant,
}

impl Progress {
    /// A run of `duration_s` of simulated time. `is_raw` says that the keyboard pilot uses the terminal.
    pub fn of_time(duration_s: f64, is_quiet: bool, is_raw: bool) -> Self {
        let kind = kind(is_quiet, is_raw);
        let bar = bar(kind, duration_s as u64, "{msg} {wide_bar} {percent:>3} %  {eta} left");
        let start = Instant::now();
        Self { bar, kind, start, duration_s, next: start + FIRST }
    }

    /// Shows the simulated time and the coverage so far.
    pub fn show(&mut self, time_s: f64, coverage: Option<f64>) {
        if self.kind == Kind::Silent || Instant::now() < self.next {
            return;
        }
        let wait = if self.kind == Kind::Bar { Duration::from_secs(1) / BAR_HZ.into() } else { LINE_EVERY };
        self.next = Instant::now() + wait;
        let speed = time_s / self.start.elapsed().as_secs_f64().max(1e-3);
        let seen = coverage.map_or(String::new(), |share| format!(", seen {:.1} %", 100.0 * share));
        let line = format!("{time_s:.0} of {:.0} s, {speed:.0} x real time{seen}", self.duration_s);
        if self.kind == Kind::Bar {
            self.bar.set_position(time_s as u64);
            self.bar.set_message(line);
        } else {
            say(stderr(), format_args!("{line}\r")); // a raw terminal needs the carriage return
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// The progress of many trials, from any thread.
pub struct TrialProgress {
    bar: ProgressBar,
    /// When the next plain line is due; `None` without plain lines.
    next_line: Option<Mutex<Instant>>,
    start: Instant,
}

impl TrialProgress {
    /// The start of a number of trials.
    pub fn new(trials: usize, is_quiet: bool) -> Self {
        let kind = kind(is_quiet, false);
        let bar = bar(kind, trials as u64, "{pos} of {len} trials {wide_bar} {percent:>3} %  {eta} left");
        if kind == Kind::Bar {
            bar.enable_steady_tick(Duration::from_millis(200)); // the clock goes on during long trials
        }
        let start = Instant::now();
        let next_line = (kind == Kind::Lines).then(|| Mutex::new(start + LINE_EVERY));
        Self { bar, next_line, start }
    }

    /// Counts one more finished trial.
    pub fn step(&self) {
        self.bar.inc(1);
        let Some(next_line) = &self.next_line else { return };
        let Ok(mut next) = next_line.lock() else { return };
        if Instant::now() >= *next {
            *next += LINE_EVERY;
            let (done, all) = (self.bar.position(), self.bar.length().unwrap_or(0));
            let left_s = self.start.elapsed().as_secs_f64() * (all as f64 / done.max(1) as f64 - 1.0);
            say(stderr(), format_args!("{done} of {all} trials, {left_s:.0} s left"));
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

//! How far a run is: a bar in a terminal, plain lines elsewhere.

use evaluation::metrics::MapScores;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Between two plain lines, in wall time.
const LINE_EVERY: Duration = Duration::from_secs(5);
/// Before that there is nothing to tell.
const FIRST: Duration = Duration::from_millis(500);
/// The bar is not drawn more often.
const BAR_HZ: u8 = 10;

pub(crate) struct Progress {
    bar: ProgressBar,
    kind: Kind,
    start: Instant,
    duration_s: f64,
    next: Instant,
}

enum Kind {
    Silent,
    Bar,
    Lines,
}

impl Progress {
    pub(crate) fn new(duration_s: f64, is_quiet: bool, is_raw: bool) -> Self {
        let kind = if is_quiet {
            Kind::Silent
        } else if std::io::stderr().is_terminal() && !is_raw {
            Kind::Bar
        } else {
            Kind::Lines
        };
        let target = match kind {
            Kind::Bar => ProgressDrawTarget::stderr_with_hz(BAR_HZ),
            _ => ProgressDrawTarget::hidden(),
        };
        let bar = ProgressBar::with_draw_target(Some(duration_s as u64), target);
        let template = "{msg} {wide_bar} {percent:>3} %  {eta} left";
        bar.set_style(
            ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        let start = Instant::now();
        Self { bar, kind, start, duration_s, next: start + FIRST }
    }

    /// Shows that the run has come to `time_s`.
    pub(crate) fn show(&mut self, time_s: f64, scores: Option<MapScores>) {
        if matches!(self.kind, Kind::Silent) || Instant::now() < self.next {
            return;
        }
        let wait =
            if matches!(self.kind, Kind::Bar) { Duration::from_secs(1) / BAR_HZ.into() } else { LINE_EVERY };
        self.next = Instant::now() + wait;
        let speed = time_s / self.start.elapsed().as_secs_f64().max(1e-3);
        let seen = scores.map_or(String::new(), |scores| format!(", seen {:.1} %", 100.0 * scores.coverage));
        let line = format!("{time_s:.0} of {:.0} s, {speed:.0} x real time{seen}", self.duration_s);
        match self.kind {
            Kind::Bar => {
                self.bar.set_position(time_s as u64);
                self.bar.set_message(line);
            }
            _ => crate::say(std::io::stderr(), format_args!("{line}\r")), // raw terminals need the return
        }
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

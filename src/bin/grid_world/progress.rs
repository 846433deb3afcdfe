//! How far the trials are: a bar in a terminal, plain lines elsewhere.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Between two plain lines.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Told of every trial, from any thread.
pub(crate) struct Progress {
    bar: ProgressBar,
    /// When the next plain line is due; `None` where there is a bar, or silence.
    next_line: Option<Mutex<Instant>>,
    start: Instant,
}

impl Progress {
    pub(crate) fn new(trials: usize, is_quiet: bool) -> Self {
        let is_bar = !is_quiet && std::io::stderr().is_terminal();
        let target = if is_bar { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(trials as u64), target);
        let template = "{pos} of {len} trials {wide_bar} {percent:>3} %  {eta} left";
        bar.set_style(
            ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        if is_bar {
            bar.enable_steady_tick(Duration::from_millis(200)); // the clock goes on through long trials
        }
        let start = Instant::now();
        let next_line = (!is_bar && !is_quiet).then(|| Mutex::new(start + LINE_EVERY));
        Self { bar, next_line, start }
    }

    /// One more trial is finished.
    pub(crate) fn step(&self) {
        self.bar.inc(1);
        let Some(next_line) = &self.next_line else { return };
        let Ok(mut next) = next_line.lock() else { return };
        if Instant::now() >= *next {
            *next += LINE_EVERY;
            let (done, all) = (self.bar.position(), self.bar.length().unwrap_or(0));
            let left_s = self.start.elapsed().as_secs_f64() * (all as f64 / done.max(1) as f64 - 1.0);
            crate::say(std::io::stderr(), format_args!("{done} of {all} trials, {left_s:.0} s left"));
        }
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

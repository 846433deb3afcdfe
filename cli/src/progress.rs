//! The progress of a run: a bar in a terminal, plain lines elsewhere.

use crate::terminal::{is_quiet, say};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressState, ProgressStyle};
use interfaces::printable;
use results::numbers::{duration, percent};
use std::fmt::{self, Display};
use std::io::{IsTerminal, stderr};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// The wall time between two plain lines.
const LINE_EVERY: Duration = Duration::from_secs(5);
/// The wall time between two states of the bar.
const BAR_EVERY: Duration = Duration::from_millis(250);
/// The wall time before the first message on simulated time.
const FIRST: Duration = Duration::from_millis(500);

/// The kind of progress of a run.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Silent,
    Bar,
    Lines,
}

/// The progress of one run in simulated time, of one log, or of many trials, which may run on any thread. The bar vanishes
/// when the value is dropped.
pub struct Progress {
    /// The position is in milliseconds of simulated time, or in trials.
    bar: ProgressBar,
    kind: Kind,
    /// The time of the next message.
    next: Mutex<Instant>,
    /// The simulated time at which the run began, s.
    from_s: f64,
}

impl Progress {
    /// A run of `duration_s` of simulated time.
    pub fn of_time(duration_s: f64) -> Self {
        Self::new(milliseconds(duration_s), OF_TIME, FIRST)
    }

    /// The same, of a run that goes on from a simulated time.
    #[must_use]
    pub fn from(self, from_s: f64) -> Self {
        self.bar.set_length(self.bar.length().unwrap_or(0).saturating_sub(milliseconds(from_s)));
        Self { from_s, ..self }
    }

    /// A number of `what`: trials, or scans of a log.
    pub fn of_count(count: usize, what: &'static str) -> Self {
        let progress = Self::new(count as u64, OF_COUNT, LINE_EVERY);
        progress.bar.set_prefix(what);
        if progress.kind == Kind::Bar {
            progress.bar.enable_steady_tick(BAR_EVERY); // The time left changes during long trials.
        }
        progress
    }

    /// Work of a length that is not known: a spinner in a terminal, nothing elsewhere.
    pub fn of_work(what: String) -> Self {
        let progress = Self::new(0, OF_WORK, LINE_EVERY);
        progress.bar.set_message(printable(&what).into_owned());
        if progress.kind == Kind::Bar {
            progress.bar.enable_steady_tick(BAR_EVERY);
        }
        progress
    }

    fn new(length: u64, template: &str, first: Duration) -> Self {
        let (kind, target) = if is_quiet() {
            (Kind::Silent, ProgressDrawTarget::hidden())
        } else if stderr().is_terminal() {
            (Kind::Bar, ProgressDrawTarget::stderr())
        } else {
            (Kind::Lines, ProgressDrawTarget::hidden())
        };
        let (bar, next) = (bar(length, template, target), Mutex::new(Instant::now() + first));
        Self { bar, kind, next, from_s: 0.0 }
    }

    /// Whether a message is due. If it is, the time of the next message is set.
    fn is_due(&self) -> bool {
        let Ok(mut next) = self.next.lock() else { return false };
        let is_due = Instant::now() >= *next;
        if is_due {
            *next = Instant::now() + if self.kind == Kind::Bar { BAR_EVERY } else { LINE_EVERY };
        }
        is_due
    }

    /// Shows the simulated time so far, at most a few times per second. `coverage` is called only when it is shown.
    pub fn show(&self, time_s: f64, coverage: impl FnOnce() -> f64) {
        if self.kind == Kind::Silent || !self.is_due() {
            return;
        }
        let all_s = self.from_s + self.bar.length().unwrap_or(0) as f64 / 1000.0;
        let speed = (time_s - self.from_s) / self.bar.elapsed().as_secs_f64().max(1e-3);
        let state = state(time_s, all_s, speed, coverage());
        // The text first: each of the two draws the bar.
        self.bar.set_message(state.clone());
        self.bar.set_position(milliseconds(time_s - self.from_s));
        if self.kind == Kind::Lines {
            say(stderr(), format_args!("{state}, {}", self.time_left()));
        }
    }

    /// Counts one more finished trial or scan.
    pub fn step(&self) {
        self.bar.inc(1);
        if self.kind == Kind::Lines && self.is_due() {
            let (done, all) = (self.bar.position(), self.bar.length().unwrap_or(0));
            say(stderr(), format_args!("{done} of {all} {}, {}", self.bar.prefix(), self.time_left()));
        }
    }

    /// Prints a line to the error output, above the bar.
    pub fn say(&self, what: impl Display) {
        self.bar.suspend(|| say(stderr(), format_args!("{what}")));
    }

    fn time_left(&self) -> String {
        time_left(self.bar.position(), self.bar.length(), self.bar.elapsed())
    }
}

/// The state of a run in simulated time; `speed` is simulated time divided by wall time, `coverage` the share of the cells that can be
/// seen that have been seen.
fn state(time_s: f64, all_s: f64, speed: f64, coverage: f64) -> String {
    let (decimals, seen) = (decimals(speed), percent(coverage));
    format!("{time_s:.0} of {all_s:.0} s at {speed:.decimals$} x, seen {seen}")
}

/// The decimals of a speed: a slow run must not have the speed 0.
fn decimals(speed: f64) -> usize {
    match speed {
        speed if speed < 0.1 => 4,
        speed if speed < 10.0 => 1,
        _ => 0,
    }
}

fn milliseconds(time_s: f64) -> u64 {
    (1000.0 * time_s).round() as u64
}

const OF_TIME: &str = "{done:>3} % {wide_bar} {msg}, {left}";
const OF_COUNT: &str = "{done:>3} % {wide_bar} {pos} of {len} {prefix}, {left}";
const OF_WORK: &str = "{spinner} {msg}, {elapsed} so far";

fn bar(length: u64, template: &str, target: ProgressDrawTarget) -> ProgressBar {
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    // Writing to a text in memory cannot fail.
    let done = |state: &ProgressState, to: &mut dyn fmt::Write| {
        let percent = 100 * state.pos() / state.len().unwrap_or(0).max(1); // rounded down: 100 % is the end
        let _ = write!(to, "{percent}");
    };
    let left = |state: &ProgressState, to: &mut dyn fmt::Write| {
        let _ = to.write_str(&time_left(state.pos(), state.len(), state.elapsed()));
    };
    let style = style.with_key("done", done).with_key("left", left);
    let bar = ProgressBar::with_draw_target(Some(length), target).with_style(style);
    bar.with_finish(ProgressFinish::AndClear)
}

/// The wall time that remains if the run goes on at its mean speed so far.
fn time_left(done: u64, all: Option<u64>, elapsed: Duration) -> String {
    if done == 0 {
        return "? s left".into();
    }
    let left_s = elapsed.as_secs_f64() * (all.unwrap_or(0) as f64 / done as f64 - 1.0).max(0.0);
    format!("{} left", duration(left_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use indicatif::TermLike;
    use std::io;
    use std::sync::Arc;

    /// A terminal with a width, and all that was written to it.
    #[derive(Clone, Debug)]
    struct Terminal(u16, Arc<Mutex<String>>);

    impl TermLike for Terminal {
        fn width(&self) -> u16 {
            self.0
        }
        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn write_line(&self, text: &str) -> io::Result<()> {
            self.write_str(&format!("{text}\n"))
        }
        fn write_str(&self, text: &str) -> io::Result<()> {
            self.1.lock().unwrap().push_str(text);
            Ok(())
        }
        fn clear_line(&self) -> io::Result<()> {
            self.write_str("\n")
        }
        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    /// The lines of a bar in a terminal of `columns`.
    fn drawn(columns: u16, template: &str, [done, all]: [u64; 2], message: &str) -> Vec<String> {
        let terminal = Terminal(columns, Arc::default());
        let target = ProgressDrawTarget::term_like(Box::new(terminal.clone()));
        let bar = bar(all, template, target).with_elapsed(Duration::from_secs(30));
        bar.set_message(message.to_owned());
        bar.set_prefix("trials");
        bar.set_position(done);
        bar.force_draw();
        let text = terminal.1.lock().unwrap();
        text.lines().map(|line| line.trim_end().to_owned()).filter(|line| !line.is_empty()).collect()
    }

    #[test]
    fn the_bar_fits_its_terminal() {
        let state = state(1199.0, 1200.0, 412.3, 0.99999);
        for columns in [60, 80, 200] {
            let of_time = drawn(columns, OF_TIME, [1_199_000, 1_200_000], &state);
            let of_trials = drawn(columns, OF_COUNT, [3, 40], "");
            assert!(!of_time.is_empty() && !of_trials.is_empty());
            for line in of_time.iter().chain(&of_trials) {
                assert!(line.chars().count() <= usize::from(columns), "{columns}: {line:?}");
                assert!(line.contains(['█', '░']), "{columns}: {line:?}");
            }
        }
        let [.., last] = &drawn(60, OF_TIME, [600_000, 1_200_000], &state)[..] else { panic!() };
        assert!(
            last.starts_with(" 50 % █") && last.ends_with("1199 of 1200 s at 412 x, seen >99.9 %, 30 s left"),
            "{last}"
        );
    }

    #[test]
    fn what_remains_is_never_zero_before_the_start() {
        let left = |done, elapsed_s| time_left(done, Some(1000), Duration::from_secs(elapsed_s));
        assert_eq!(
            [left(0, 5), left(500, 5), left(10, 60), left(1, 60), left(1000, 60)],
            ["? s left", "5 s left", "99 min left", "17 h left", "0 s left"]
        );
    }

    #[test]
    fn a_slow_run_has_a_speed() {
        let line = |speed| state(1.0, 60.0, speed, 0.5);
        assert_eq!(line(0.001), "1 of 60 s at 0.0010 x, seen 50.0 %");
        assert_eq!(line(1.0), "1 of 60 s at 1.0 x, seen 50.0 %");
        assert_eq!(line(412.3), "1 of 60 s at 412 x, seen 50.0 %");
    }
}

//! An entity of the recording.
//!
//! One call of the SDK per row costs some tens of microseconds. Rows are therefore collected here and sent as
//! columns, many ticks at once.

use crate::scene::TimeUnit;
use crate::view::View;
use rerun::{AsComponents, RecordingStream, RecordingStreamResult, TimeColumn};

/// The timeline of the simulated time.
pub(super) const SIM_TIME: &str = "sim_time";
/// The timeline of readings, or of steps.
pub(super) const STEP: &str = "step";

/// The timeline that a viewer opens with.
pub(super) fn timeline(unit: TimeUnit) -> &'static str {
    unit.choose(SIM_TIME, STEP)
}

/// An entity that changes during a run.
pub(super) trait Track: Send {
    /// Appends the rows of `view` if they are due or the last.
    fn push(&mut self, view: &View, is_last: bool);

    /// Sends the rows. Where time is counted in steps, there is no other timeline.
    fn flush(&mut self, stream: &RecordingStream, unit: TimeUnit) -> RecordingStreamResult<()>;
}

/// How the items of a view become rows.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// A row has all items, and is logged when they have changed. A row without items clears the entity.
    State,
    /// Every item is a row.
    Events,
}

/// An entity whose items are read from a view by a function, with the rows that were not sent yet.
pub(super) struct Entity<T, F, C> {
    path: String,
    kind: Kind,
    /// The time between two rows, in the unit of the scene; 0 for every view.
    period: f64,
    items_of: F,
    /// The components of the items of many rows.
    components: fn(Vec<T>) -> C,
    due: f64,
    last: Vec<T>,
    times_ns: Vec<i64>,
    steps: Vec<i64>,
    /// The number of items of each row.
    lengths: Vec<usize>,
    items: Vec<T>,
}

impl<T, F, C> Entity<T, F, C> {
    pub(super) fn new(
        path: String,
        kind: Kind,
        period: f64,
        items_of: F,
        components: fn(Vec<T>) -> C,
    ) -> Self {
        let (due, last, items) = (f64::NEG_INFINITY, Vec::new(), Vec::new());
        let (times_ns, steps, lengths) = (Vec::new(), Vec::new(), Vec::new());
        Self { path, kind, period, items_of, components, due, last, times_ns, steps, lengths, items }
    }

    fn append(&mut self, view: &View, items: impl IntoIterator<Item = T>) {
        let before = self.items.len();
        self.items.extend(items);
        self.times_ns.push((view.time * 1e9).round() as i64);
        self.steps.push(view.step as i64);
        self.lengths.push(self.items.len() - before);
    }
}

impl<T, F, C> Track for Entity<T, F, C>
where
    T: Clone + PartialEq + Send,
    F: FnMut(&View) -> Vec<T> + Send,
    C: AsComponents,
{
    fn push(&mut self, view: &View, is_last: bool) {
        // Half a millisecond of slack: 0.1 added ten times is not 1.
        if view.time < self.due - 5e-4 && !is_last {
            return;
        }
        let items = (self.items_of)(view);
        // An event that has not happened yet is not waited for.
        if self.kind == Kind::State || !items.is_empty() {
            self.due = view.time + self.period;
        }
        match self.kind {
            Kind::State if items != self.last => {
                self.last.clone_from(&items);
                self.append(view, items);
            }
            Kind::State => {}
            Kind::Events => items.into_iter().for_each(|item| self.append(view, [item])),
        }
    }

    fn flush(&mut self, stream: &RecordingStream, unit: TimeUnit) -> RecordingStreamResult<()> {
        if self.lengths.is_empty() {
            return Ok(());
        }
        let times_ns = std::mem::take(&mut self.times_ns);
        let mut times = vec![TimeColumn::new_sequence(STEP, std::mem::take(&mut self.steps))];
        if unit == TimeUnit::Second {
            times.push(TimeColumn::new_duration_nanos(SIM_TIME, times_ns));
        }
        let lengths = std::mem::take(&mut self.lengths);
        let components = (self.components)(std::mem::take(&mut self.items));
        let columns = components.as_serialized_batches().into_iter();
        let columns = columns.map(|batch| batch.partitioned(lengths.iter().copied()));
        stream.send_columns(self.path.as_str(), times, columns.collect::<Result<Vec<_>, _>>()?)
    }
}

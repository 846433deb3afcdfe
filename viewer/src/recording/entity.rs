//! An entity of the recording. To add an entity, see `tracks/`.
//!
//! One call of the SDK per row takes some tens of microseconds. Rows are therefore collected here and sent as
//! columns, many ticks at once.

use draw::view::View;
use rerun::{AsComponents, RecordingStream, RecordingStreamResult, TimeColumn};

/// The timeline of the simulated time, which is active when a viewer opens.
pub(super) const SIM_TIME: &str = "sim_time";
/// The timeline of readings.
const STEP: &str = "step";

/// An entity that changes during a run.
pub(super) trait Track: Send {
    /// Appends the rows of `view` if they are due, or if the view is the last one.
    fn push(&mut self, view: &View, is_last: bool);

    /// Sends the rows.
    fn flush(&mut self, stream: &RecordingStream) -> RecordingStreamResult<()>;
}

/// How the items of a view become rows.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// A row has all items, and is logged when the items have changed. A row without items clears the entity.
    State,
    /// Every item is a row.
    Events,
}

/// An entity whose items are read from a view by a function, with the rows that were not sent yet.
pub(super) struct Entity<T, F, C> {
    path: String,
    kind: Kind,
    /// The time between two rows, s; 0 for every view.
    period_s: f64,
    items_of: F,
    /// The components of the items of many rows.
    components: fn(Vec<T>) -> C,
    due_s: f64,
    last: Vec<T>,
    /// Step, time in nanoseconds, and items of every row.
    rows: Vec<(i64, i64, Vec<T>)>,
}

impl<T, F, C> Entity<T, F, C> {
    pub(super) fn new(
        path: String,
        (kind, period_s): (Kind, f64),
        items_of: F,
        components: fn(Vec<T>) -> C,
    ) -> Self {
        let (due_s, last, rows) = (f64::NEG_INFINITY, Vec::new(), Vec::new());
        Self { path, kind, period_s, items_of, components, due_s, last, rows }
    }
}

impl<T, F, C> Track for Entity<T, F, C>
where
    T: Clone + PartialEq + Send,
    F: FnMut(&View) -> Vec<T> + Send,
    C: AsComponents,
{
    fn push(&mut self, view: &View, is_last: bool) {
        // Half a millisecond of tolerance: 0.1 added ten times is not exactly 1.
        if view.time_s < self.due_s - 5e-4 && !is_last {
            return;
        }
        let items = (self.items_of)(view);
        // The period of events begins with an event: a view without events does not start a new period.
        if self.kind == Kind::State || !items.is_empty() {
            self.due_s = view.time_s + self.period_s;
        }
        let rows = match self.kind {
            Kind::State if items == self.last => Vec::new(),
            Kind::State => {
                self.last.clone_from(&items);
                vec![items]
            }
            Kind::Events => items.into_iter().map(|item| vec![item]).collect(),
        };
        let (step, time_ns) = (view.step as i64, (view.time_s * 1e9).round() as i64);
        self.rows.extend(rows.into_iter().map(|items| (step, time_ns, items)));
    }

    fn flush(&mut self, stream: &RecordingStream) -> RecordingStreamResult<()> {
        let rows = std::mem::take(&mut self.rows);
        if rows.is_empty() {
            return Ok(());
        }
        let steps: Vec<i64> = rows.iter().map(|row| row.0).collect();
        let times_ns: Vec<i64> = rows.iter().map(|row| row.1).collect();
        let lengths: Vec<usize> = rows.iter().map(|row| row.2.len()).collect();
        let times =
            [TimeColumn::new_sequence(STEP, steps), TimeColumn::new_duration_nanos(SIM_TIME, times_ns)];
        let components = (self.components)(rows.into_iter().flat_map(|row| row.2).collect());
        let columns = components.as_serialized_batches().into_iter();
        let columns = columns.map(|batch| batch.partitioned(lengths.iter().copied()));
        stream.send_columns(self.path.as_str(), times, columns.collect::<Result<Vec<_>, _>>()?)
    }
}

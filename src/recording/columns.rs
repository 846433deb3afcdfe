//! Rows that wait for their chunk.
//!
//! The SDK's way to log, one call per row, costs some tens of microseconds per row. Rows are
//! therefore collected here and handed over as columns, many ticks at once.

use rerun::components::ImageBuffer;
use rerun::{
    Arrows2D, LineStrips2D, Points2D, RecordingStream, Scalars, SegmentationImage, SerializationResult,
    SerializedComponentColumn, StateChange, TextLog, TimeColumn,
};

/// The timeline of the simulated time.
pub(super) const SIM_TIME: &str = "sim_time";
/// The timeline that counts readings.
pub(super) const STEP: &str = "step";

/// An instant on both timelines.
#[derive(Clone, Copy)]
pub(super) struct Now {
    pub(super) time_s: f64,
    pub(super) step: u64,
}

/// What a row can hold any number of.
pub(super) trait Item: Sized {
    /// Turns the items of many rows into columns; `lengths` has the number of items of each row.
    fn columns(items: Vec<Self>, lengths: Vec<usize>) -> SerializationResult<Vec<SerializedComponentColumn>>;
}

/// The rows of one entity that were not handed over yet.
pub(super) struct Rows<T> {
    entity: String,
    times_ns: Vec<i64>,
    steps: Vec<i64>,
    lengths: Vec<usize>,
    items: Vec<T>,
}

impl<T: Item> Rows<T> {
    /// No rows of `entity`.
    pub(super) fn new(entity: impl Into<String>) -> Self {
        let entity = entity.into();
        Self { entity, times_ns: Vec::new(), steps: Vec::new(), lengths: Vec::new(), items: Vec::new() }
    }

    /// Appends a row. A row without items clears the entity from then on.
    pub(super) fn push(&mut self, now: Now, items: impl IntoIterator<Item = T>) {
        let before = self.items.len();
        self.items.extend(items);
        self.times_ns.push((now.time_s * 1e9).round() as i64);
        self.steps.push(now.step as i64);
        self.lengths.push(self.items.len() - before);
    }

    /// Hands the rows over as one chunk.
    pub(super) fn flush(&mut self, stream: &RecordingStream) -> Result<(), String> {
        if self.lengths.is_empty() {
            return Ok(());
        }
        let times = [
            TimeColumn::new_duration_nanos(SIM_TIME, std::mem::take(&mut self.times_ns)),
            TimeColumn::new_sequence(STEP, std::mem::take(&mut self.steps)),
        ];
        let columns = T::columns(std::mem::take(&mut self.items), std::mem::take(&mut self.lengths));
        let columns = columns.map_err(|error| error.to_string())?;
        stream.send_columns(self.entity.as_str(), times, columns).map_err(|error| error.to_string())
    }
}

/// A place, m.
pub(super) type Place = [f32; 2];

impl Item for Place {
    fn columns(items: Vec<Self>, lengths: Vec<usize>) -> SerializationResult<Vec<SerializedComponentColumn>> {
        Ok(Points2D::update_fields().with_positions(items).columns(lengths)?.collect())
    }
}

/// An arrow from a place, m.
pub(super) struct Arrow {
    pub(super) origin: Place,
    pub(super) vector: Place,
}

impl Item for Arrow {
    fn columns(items: Vec<Self>, lengths: Vec<usize>) -> SerializationResult<Vec<SerializedComponentColumn>> {
        let arrows = Arrows2D::update_fields()
            .with_origins(items.iter().map(|arrow| arrow.origin))
            .with_vectors(items.iter().map(|arrow| arrow.vector));
        Ok(arrows.columns(lengths)?.collect())
    }
}

/// Joined lines, m.
pub(super) struct Strip(pub(super) Vec<Place>);

impl Item for Strip {
    fn columns(items: Vec<Self>, lengths: Vec<usize>) -> SerializationResult<Vec<SerializedComponentColumn>> {
        let strips = items.into_iter().map(|strip| strip.0);
        Ok(LineStrips2D::update_fields().with_strips(strips).columns(lengths)?.collect())
    }
}

impl Item for f64 {
    fn columns(items: Vec<Self>, lengths: Vec<usize>) -> SerializationResult<Vec<SerializedComponentColumn>> {
        Ok(Scalars::update_fields().with_scalars(items).columns(lengths)?.collect())
    }
}

/// A line of the log with its level in the viewer's terms.
pub(super) struct Line {
    pub(super) text: String,
    pub(super) level: &'static str,
}

impl Item for Line {
    fn columns(items: Vec<Self>, lengths: Vec<usize>) -> SerializationResult<Vec<SerializedComponentColumn>> {
        let lines = TextLog::update_fields()
            .with_many_level(items.iter().map(|line| line.level))
            .with_many_text(items.into_iter().map(|line| line.text));
        Ok(lines.columns(lengths)?.collect())
    }
}

/// The state that begins.
pub(super) struct State(pub(super) String);

impl Item for State {
    fn columns(items: Vec<Self>, lengths: Vec<usize>) -> SerializationResult<Vec<SerializedComponentColumn>> {
        let states = items.into_iter().map(|state| state.0);
        Ok(StateChange::update_fields().with_state(states).columns(lengths)?.collect())
    }
}

/// The class of every cell; the size of the picture is logged once, beside it.
pub(super) struct Classes(pub(super) Vec<u8>);

impl Item for Classes {
    fn columns(items: Vec<Self>, lengths: Vec<usize>) -> SerializationResult<Vec<SerializedComponentColumn>> {
        let buffers = items.into_iter().map(|classes| ImageBuffer(classes.0.into()));
        Ok(SegmentationImage::update_fields().with_many_buffer(buffers).columns(lengths)?.collect())
    }
}

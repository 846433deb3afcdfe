//! Rows that wait to be sent.
//!
//! One call of the SDK per row costs some tens of microseconds. Rows are therefore collected here and sent as
//! columns, many ticks at once.

use crate::scene::TimeUnit;
use nalgebra::Point2;
use rerun::components::ImageBuffer;
use rerun::{
    Arrows2D, LineStrips2D, Points2D, RecordingStream, RecordingStreamResult, Scalars, SegmentationImage,
    SerializationResult, SerializedComponentColumn, StateChange, TextLog, TimeColumn, Transform3D,
};

/// The timeline of the simulated time.
pub(super) const SIM_TIME: &str = "sim_time";
/// The timeline of readings, or of steps.
pub(super) const STEP: &str = "step";

/// The timeline that a viewer opens with.
pub(super) fn timeline(unit: TimeUnit) -> &'static str {
    match unit {
        TimeUnit::Second => SIM_TIME,
        TimeUnit::Step => STEP,
    }
}

/// An instant on both timelines.
#[derive(Clone, Copy)]
pub(super) struct Now {
    pub(super) time: f64,
    pub(super) step: u64,
}

/// An element of a row; a row can have any number of them.
pub(super) trait Item: Sized {
    /// The columns of many rows; `lengths` has the number of items of each row.
    fn columns(items: Vec<Self>, lengths: Vec<usize>) -> SerializationResult<Vec<SerializedComponentColumn>>;
}

/// The rows of one entity that were not sent yet.
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
        self.times_ns.push((now.time * 1e9).round() as i64);
        self.steps.push(now.step as i64);
        self.lengths.push(self.items.len() - before);
    }

    /// Sends the rows as one chunk.
    pub(super) fn flush(&mut self, to: Target) -> RecordingStreamResult<()> {
        if self.lengths.is_empty() {
            return Ok(());
        }
        let times_ns = std::mem::take(&mut self.times_ns);
        let mut times = vec![TimeColumn::new_sequence(STEP, std::mem::take(&mut self.steps))];
        if to.unit == TimeUnit::Second {
            times.push(TimeColumn::new_duration_nanos(SIM_TIME, times_ns));
        }
        let columns = T::columns(std::mem::take(&mut self.items), std::mem::take(&mut self.lengths))?;
        to.stream.send_columns(self.entity.as_str(), times, columns)
    }
}

/// Where rows are sent. Where time is counted in steps, there is no other timeline.
#[derive(Clone, Copy)]
pub(super) struct Target<'a> {
    pub(super) stream: &'a RecordingStream,
    pub(super) unit: TimeUnit,
}

/// A position, m.
pub(super) type Position = [f32; 2];

/// A point as the SDK takes it.
pub(super) fn position(point: &Point2<f64>) -> Position {
    [point.x as f32, point.y as f32]
}

impl Item for Position {
    fn columns(items: Vec<Self>, lengths: Vec<usize>) -> SerializationResult<Vec<SerializedComponentColumn>> {
        Ok(Points2D::update_fields().with_positions(items).columns(lengths)?.collect())
    }
}

/// The position of everything below the entity, m.
pub(super) struct Shift(pub(super) Position);

impl Item for Shift {
    fn columns(items: Vec<Self>, lengths: Vec<usize>) -> SerializationResult<Vec<SerializedComponentColumn>> {
        let to = items.into_iter().map(|Shift([x, y])| [x, y, 0.0]);
        Ok(Transform3D::update_fields().with_many_translation(to).columns(lengths)?.collect())
    }
}

/// An arrow from a position, m.
pub(super) struct Arrow {
    pub(super) origin: Position,
    pub(super) vector: Position,
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
pub(super) struct Strip(pub(super) Vec<Position>);

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

/// A line of the log with its level in the terms of the viewer.
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

/// The class of every cell; the size of the image is logged once.
pub(super) struct Classes(pub(super) Vec<u8>);

impl Item for Classes {
    fn columns(items: Vec<Self>, lengths: Vec<usize>) -> SerializationResult<Vec<SerializedComponentColumn>> {
        let buffers = items.into_iter().map(|classes| ImageBuffer(classes.0.into()));
        Ok(SegmentationImage::update_fields().with_many_buffer(buffers).columns(lengths)?.collect())
    }
}

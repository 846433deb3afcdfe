//! The entities of a recording: their constant style, which is logged once, and the items of each view of the run.
//!
//! To add an entity: write a function that logs the style with `Tracks::always` and calls `Tracks::add`, and add a
//! line to [`start`].

mod bodies;
mod curves;
mod estimate;
mod maps;

pub(super) use bodies::robot;
pub(super) use curves::{STRATEGY, has_choice, plots};
pub(super) use maps::map;

use draw::palette::Rgb;
use draw::scene::Scene;
use draw::view::View;
use nalgebra::Point2;
use rerun::{
    AsComponents, Color, EntityPathPart, LineStrips2D, Points2D, Radius, RecordingStream,
    RecordingStreamResult, TextLog, TextLogLevel, TimeColumn,
};
use robot::Level;

/// The entity above everything that has a position.
pub(super) const WORLD: &str = "/world";
/// The messages of the run.
pub(super) const LOG: &str = "/log";

/// The entities so far, and the data from which they are made.
struct Tracks<'a> {
    stream: &'a RecordingStream,
    scene: &'a Scene,
    /// The first view of the run.
    view: &'a View<'a>,
    tracks: Vec<Box<dyn Track>>,
}

/// Logs the constant style of all entities, and returns the entities that change. `view` is the first view of the
/// run.
pub(super) fn start(
    stream: &RecordingStream,
    scene: &Scene,
    view: &View,
) -> RecordingStreamResult<Vec<Box<dyn Track>>> {
    let mut tracks = Tracks { stream, scene, view, tracks: Vec::new() };
    maps::add(&mut tracks)?;
    bodies::add(&mut tracks)?;
    estimate::add(&mut tracks)?;
    curves::add(&mut tracks)?;
    messages(&mut tracks);
    Ok(tracks.tracks)
}

impl Tracks<'_> {
    /// Logs components that never change.
    fn always(&self, path: &str, components: &impl AsComponents) -> RecordingStreamResult<()> {
        self.stream.log_static(path, components)
    }

    /// Adds an entity; see [`Entity`].
    fn add<T, C>(
        &mut self,
        path: impl Into<String>,
        when: (Kind, f64),
        items_of: impl FnMut(&View) -> Vec<T> + Send + 'static,
        components: fn(Vec<T>) -> C,
    ) where
        T: Clone + PartialEq + Send + 'static,
        C: AsComponents + 'static,
    {
        self.tracks.push(Box::new(Entity::new(path.into(), when, items_of, components)));
    }
}

/// A row when something has changed.
const ON_CHANGE: (Kind, f64) = (Kind::State, 0.0);
/// A row for every event.
const EVENTS: (Kind, f64) = (Kind::Events, 0.0);

/// Adds the messages of the run. The first is the name of the world, so that the log is never empty.
fn messages(tracks: &mut Tracks) {
    let mut first = Some((TextLogLevel::INFO, format!("the run in {} starts", tracks.scene.title)));
    let lines = move |view: &View| {
        let messages = view.measured.messages.iter().map(|message| {
            let level = match message.level {
                Level::Decision => TextLogLevel::INFO,
                Level::Event => TextLogLevel::WARN,
                Level::Trouble => TextLogLevel::ERROR,
            };
            (level, message.text.clone())
        });
        first.take().into_iter().chain(messages).collect()
    };
    tracks.add(LOG, EVENTS, lines, |lines| {
        let (levels, texts): (Vec<_>, Vec<_>) = lines.into_iter().unzip();
        TextLog::update_fields().with_many_level(levels).with_many_text(texts)
    });
}

/// The drawing order, from the lowest to the highest layer.
mod order {
    pub(super) const MAP: f32 = -10.0;
    pub(super) const WALLS: f32 = 1.0;
    pub(super) const SIGHT_OUTLINE: f32 = 2.0;
    pub(super) const TRAIL: f32 = 3.0;
    pub(super) const OTHER_TRAIL: f32 = 3.5;
    pub(super) const PATH: f32 = 4.0;
    pub(super) const BODY: f32 = 5.0;
    pub(super) const HEADING: f32 = 6.0;
}

/// The color of labels. The viewer writes them on a gray ground, where only dark letters are legible.
const LABEL: Rgb = [16, 18, 24];

fn color([red, green, blue]: Rgb, alpha: u8) -> Color {
    Color::from_unmultiplied_rgba(red, green, blue, alpha)
}

/// The appearance of lines with half a width in points of the viewer.
fn line(color: Color, radius: f32, order: f32) -> LineStrips2D {
    LineStrips2D::update_fields()
        .with_colors([color])
        .with_radii([Radius::new_ui_points(radius)])
        .with_draw_order(order)
}

/// A position, m.
type Position = [f32; 2];
/// Joined lines, m.
type Strip = Vec<Position>;

fn position(point: &Point2<f64>) -> Position {
    [point.x as f32, point.y as f32]
}

/// The components of lines.
fn strips(strips: Vec<Strip>) -> LineStrips2D {
    LineStrips2D::update_fields().with_strips(strips)
}

/// The components of points.
fn points(points: Vec<Position>) -> Points2D {
    Points2D::update_fields().with_positions(points)
}

/// An outline as a line that ends where it begins.
fn closed(outline: &[Point2<f64>]) -> Strip {
    outline.iter().chain(outline.first()).map(position).collect()
}

/// A name from a world file as one part of a path, whatever characters it has.
fn escape(name: &str) -> String {
    EntityPathPart::new(name).escaped_string()
}

// An entity of the recording. To add an entity, see `tracks/`.
//
// One call of the SDK per row takes some tens of microseconds. Rows are therefore collected here and sent as
// columns, many ticks at once.

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
enum Kind {
    /// A row has all items, and is logged when the items have changed. A row without items clears the entity.
    State,
    /// Every item is a row.
    Events,
}

/// An entity whose items are read from a view by a function, with the rows that were not sent yet.
struct Entity<T, F, C> {
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
    fn new(path: String, (kind, period_s): (Kind, f64), items_of: F, components: fn(Vec<T>) -> C) -> Self {
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

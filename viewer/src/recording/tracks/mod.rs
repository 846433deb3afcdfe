//! The entities of a recording, one file for each kind: how they look, which is logged once, and their rows.

mod curves;
mod field_of_view;
mod legend;
mod log;
mod maps;
mod obstacles;
mod plan;
mod robots;

pub(super) use curves::{has_choice, plots};
pub(super) use legend::SHARE as LEGEND_SHARE;
pub(super) use maps::BAR_SHARE;

use super::pace::Pace;
use super::rows::{Now, Position, Target, position};
use crate::scene::{Outline, Scene};
use crate::view::View;
use evaluation::palette::Rgb;
use rerun::{Color, RecordingStream, RecordingStreamResult};

/// One kind of entity while a run goes on.
pub(super) trait Track: Send {
    /// Appends the rows that are due; all of them if `is_last`.
    fn push(&mut self, now: Now, view: &View, is_last: bool);

    /// Sends the rows.
    fn flush(&mut self, to: Target) -> RecordingStreamResult<()>;
}

/// What the tracks are made from.
#[derive(Clone, Copy)]
struct Start<'a> {
    stream: &'a RecordingStream,
    scene: &'a Scene,
    view: &'a View<'a>,
    pace: Pace,
}

/// Logs how everything looks, and returns every track. `view` is the first view of the run.
pub(super) fn start(
    stream: &RecordingStream,
    scene: &Scene,
    view: &View,
) -> RecordingStreamResult<Vec<Box<dyn Track>>> {
    let start = Start { stream, scene, view, pace: Pace::of(scene.unit) };
    legend::log(start)?;
    Ok(vec![
        Box::new(maps::Maps::new(start)?),
        Box::new(field_of_view::FieldOfView::new(start)?),
        Box::new(obstacles::Obstacles::new(start)?),
        Box::new(robots::Robots::new(start)?),
        Box::new(plan::Plan::new(start)?),
        Box::new(curves::Curves::new(start)?),
        Box::new(log::Log::new(start)),
    ])
}

/// What is drawn over what, from the bottom up.
mod order {
    pub(super) const MAP: f32 = -10.0;
    pub(super) const FIELD_OF_VIEW: f32 = -9.0;
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

/// An outline as a line that ends where it begins.
fn closed(outline: &Outline) -> Vec<Position> {
    outline.iter().chain(outline.first()).map(position).collect()
}

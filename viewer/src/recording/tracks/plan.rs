//! The plan of the curious robot: goal and path.

use super::{Start, Track, color, order};
use crate::recording::path;
use crate::recording::rows::{Now, Position, Rows, Strip, Target, position};
use crate::view::View;
use evaluation::palette;
use nalgebra::Point2;
use rerun::{LineStrips2D, Points2D, Radius, RecordingStreamResult};

/// Each with what was logged last.
pub(super) struct Plan {
    path: (Rows<Strip>, Vec<Point2<f64>>),
    goal: (Rows<Position>, Option<Point2<f64>>),
}

impl Plan {
    pub(super) fn new(start: Start) -> RecordingStreamResult<Self> {
        let look = LineStrips2D::update_fields()
            .with_colors([color(palette::PATH, 255)])
            .with_radii([Radius::new_ui_points(1.5)])
            .with_draw_order(order::PATH);
        start.stream.log_static(path::PATH, &look)?;
        let look = Points2D::update_fields()
            .with_colors([color(palette::GOAL, 255)])
            .with_radii([Radius::new_ui_points(6.0)])
            .with_draw_order(order::PATH);
        start.stream.log_static(path::GOAL, &look)?;
        Ok(Self { path: (Rows::new(path::PATH), Vec::new()), goal: (Rows::new(path::GOAL), None) })
    }
}

impl Track for Plan {
    fn push(&mut self, now: Now, view: &View, _: bool) {
        if self.path.1 != view.path {
            let strip = (view.path.len() > 1).then(|| Strip(view.path.iter().map(position).collect()));
            self.path.0.push(now, strip);
            self.path.1 = view.path.to_vec();
        }
        if self.goal.1 != view.goal {
            self.goal.0.push(now, view.goal.as_ref().map(position));
            self.goal.1 = view.goal;
        }
    }

    fn flush(&mut self, to: Target) -> RecordingStreamResult<()> {
        self.path.0.flush(to)?;
        self.goal.0.flush(to)
    }
}

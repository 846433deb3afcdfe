//! The walls, and everything else that is no robot.

use super::{LABEL, Start, Track, closed, color, order};
use crate::recording::path;
use crate::recording::rows::{Now, Position, Rows, Strip, Target, position};
use crate::scene::Outline;
use crate::view::View;
use evaluation::palette;
use nalgebra::{Point2, center};
use rerun::{LineStrips2D, Points2D, Radius, RecordingStreamResult};

/// More names than this would hide the map; a viewer still shows them one by one.
const MAX_LABELS: usize = 4;

pub(super) struct Obstacles(Vec<ObstacleRows>);

struct ObstacleRows {
    outline: Rows<Strip>,
    /// The position of the name, if names are shown.
    label: Option<Rows<Position>>,
    /// The outline that was logged last.
    last: Option<Outline>,
}

impl Obstacles {
    pub(super) fn new(start: Start) -> RecordingStreamResult<Self> {
        let (stream, scene) = (start.stream, start.scene);
        let walls = LineStrips2D::new(scene.walls.iter().map(closed))
            .with_colors([color(palette::WALL, 255)])
            .with_radii([Radius::new_ui_points(1.0)])
            .with_draw_order(order::WALLS);
        stream.log_static(path::WALLS, &walls)?;
        let mut rows = Vec::new();
        for obstacle in &scene.obstacles {
            let entity = path::obstacle(&obstacle.name);
            let own = if obstacle.is_fixed() { palette::FURNITURE } else { palette::MOVING };
            let look = LineStrips2D::update_fields()
                .with_colors([color(own, 255)])
                .with_radii([Radius::new_ui_points(2.5)])
                .with_draw_order(order::WALLS);
            stream.log_static(entity.as_str(), &look)?;
            let label = format!("{entity}/name");
            let has_label = scene.obstacles.len() <= MAX_LABELS;
            if has_label {
                let look = Points2D::update_fields()
                    .with_colors([color(LABEL, 255)])
                    .with_radii([Radius::new_ui_points(0.0)])
                    .with_labels([obstacle.name.as_str()])
                    .with_show_labels(true);
                stream.log_static(label.as_str(), &look)?;
            }
            let label = has_label.then(|| Rows::new(label));
            rows.push(ObstacleRows { outline: Rows::new(entity), label, last: None });
        }
        Ok(Self(rows))
    }
}

impl Track for Obstacles {
    fn push(&mut self, now: Now, view: &View, _: bool) {
        for (rows, outline) in self.0.iter_mut().zip(&view.obstacles) {
            if rows.last != *outline {
                rows.outline.push(now, outline.as_ref().map(|outline| Strip(closed(outline))));
                if let Some(label) = &mut rows.label {
                    label.push(now, outline.as_ref().map(|outline| position(&middle(outline))));
                }
                rows.last.clone_from(outline);
            }
        }
    }

    fn flush(&mut self, to: Target) -> RecordingStreamResult<()> {
        self.0.iter_mut().try_for_each(|rows| {
            rows.outline.flush(to)?;
            rows.label.as_mut().map_or(Ok(()), |label| label.flush(to))
        })
    }
}

/// The middle of a rectangle.
fn middle(outline: &Outline) -> Point2<f64> {
    match outline.as_slice() {
        [a, _, c, ..] => center(a, c),
        _ => Point2::origin(),
    }
}

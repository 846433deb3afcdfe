//! What the curious robot sees: the field of view of a laser, or cells around the robot.

use super::maps::Picture;
use super::{Start, Track, color, order};
use crate::outline;
use crate::recording::pace::Due;
use crate::recording::path;
use crate::recording::rows::{Classes, Now, Rows, Shift, Strip, Target, position};
use crate::scene::Sight;
use crate::view::View;
use evaluation::palette;
use interfaces::{Cell, GridFrame};
use nalgebra::Point2;
use rerun::external::re_sdk_types::datatypes;
use rerun::{AnnotationContext, LineStrips2D, Radius, RecordingStreamResult};

/// The class of the cells in the field of view.
const IN_VIEW: u8 = 1;

/// The cells that fill the field of view. The cells of a laser are fixed to the map, with twice the side of
/// the map's cells, because there are five images per second. The cells of a robot that sees cells move with
/// the robot, so that a large map costs no more than a small one.
fn frame(sight: Sight, map: &GridFrame) -> GridFrame {
    let cell_m = map.resolution_m();
    let frame = match sight {
        Sight::Laser(_) => {
            let (width, height) = (map.width().div_ceil(2), map.height().div_ceil(2));
            GridFrame::new(map.origin(), 2.0 * cell_m, width, height)
        }
        Sight::Cells { radius, .. } => {
            let side = 2 * radius as usize + 1;
            let corner = -0.5 * side as f64 * cell_m;
            GridFrame::new(Point2::new(corner, corner), cell_m, side, side)
        }
    };
    frame.unwrap_or(*map)
}

/// The field of view during a run.
pub(super) struct FieldOfView {
    outline: Rows<Strip>,
    cells: Rows<Classes>,
    /// The position of the cells that move with the robot.
    shift: Rows<Shift>,
    frame: GridFrame,
    due: Due,
    /// The classes and the cell of the robot that were logged last.
    last: (Vec<u8>, Option<Cell>),
}

impl FieldOfView {
    pub(super) fn new(start: Start) -> RecordingStreamResult<Self> {
        let (stream, map) = (start.stream, start.view.mapper.frame());
        let sight = start.view.sight();
        let frame = sight.map_or(*map, |sight| frame(sight, map));
        if let Some(Sight::Laser(_)) = sight {
            let outline = LineStrips2D::update_fields()
                .with_colors([color(palette::SENSOR, 220)])
                .with_radii([Radius::new_ui_points(0.75)])
                .with_draw_order(order::SIGHT_OUTLINE);
            stream.log_static(path::SIGHT_OUTLINE, &outline)?;
        }
        if sight.is_some() {
            let class = |id: u8, label: &str, alpha| datatypes::AnnotationInfo {
                id: id.into(),
                label: Some(label.into()),
                color: Some(*color(palette::SENSOR, alpha)),
            };
            let classes = [class(0, "out of view", 0), class(IN_VIEW, "in view", 255)];
            stream.log_static(path::SIGHT_CELLS, &AnnotationContext::new(classes))?;
            let picture = Picture::of_frame(&frame);
            picture.log(stream, path::SIGHT_CELLS, order::FIELD_OF_VIEW, 0.25)?;
        }
        Ok(Self {
            outline: Rows::new(path::SIGHT_OUTLINE),
            cells: Rows::new(path::SIGHT_CELLS),
            shift: Rows::new(path::SIGHT),
            due: Due::every(start.pace.picture(start.pace.sight, &frame)),
            frame,
            last: (Vec::new(), None),
        })
    }
}

impl Track for FieldOfView {
    fn push(&mut self, now: Now, view: &View, is_last: bool) {
        let Some(sight) = view.sight() else { return };
        if !(self.due.now(now.time) || is_last) {
            return;
        }
        match sight {
            Sight::Laser(reading) => {
                let corners = outline::field_of_view(reading);
                self.cells.push(now, [Classes(outline::fill(&corners, &self.frame, IN_VIEW))]);
                self.outline.push(now, [Strip(corners.iter().map(position).collect())]);
            }
            Sight::Cells { reading, radius } => {
                let (map, radius) = (view.mapper.frame(), radius as i32);
                let robot = map.cell_at(&reading.pose.translation.vector.into());
                let mut cells = vec![0; self.frame.len()];
                for (cell, _) in &reading.cells {
                    let around = Cell::new(cell.x - robot.x + radius, cell.y - robot.y + radius);
                    if let Some(index) = self.frame.index(around) {
                        cells[index] = IN_VIEW;
                    }
                }
                if self.last.0 != cells {
                    self.cells.push(now, [Classes(cells.clone())]);
                    self.last.0 = cells;
                }
                if self.last.1 != Some(robot) {
                    self.shift.push(now, [Shift(position(&map.center(robot)))]);
                    self.last.1 = Some(robot);
                }
            }
        }
    }

    fn flush(&mut self, to: Target) -> RecordingStreamResult<()> {
        self.shift.flush(to)?;
        self.cells.flush(to)?;
        self.outline.flush(to)
    }
}

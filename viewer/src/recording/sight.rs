//! What the curious robot sees: a laser's field of view, or cells around it.

use super::columns::{Classes, Now, Rows, Shift, Strip};
use super::pace::{Due, Pace};
use super::scenery::{self, Picture, order};
use super::tracks::place;
use super::{entity, outline};
use crate::view::{Sight, TimeUnit, View};
use interfaces::{Cell, GridFrame};
use nalgebra::Point2;
use rerun::external::re_sdk_types::datatypes;
use rerun::{AnnotationContext, LineStrips2D, Radius, RecordingStream, RecordingStreamResult};

/// The class of the cells in the field of view.
const IN_VIEW: u8 = 1;

/// The cells in which the field of view is filled. A laser's are fixed to the map, a quarter as many
/// as its own, since there are five pictures a second; those of a robot that sees cells move with it,
/// so that a large map costs no more than a small one.
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

/// Logs how the field of view looks.
pub(super) fn send(stream: &RecordingStream, view: &View) -> RecordingStreamResult<()> {
    let Some(sight) = view.sight() else { return Ok(()) };
    if let Sight::Laser(_) = sight {
        let outline = LineStrips2D::update_fields()
            .with_colors([scenery::colour(scenery::SENSOR, 220)])
            .with_radii([Radius::new_ui_points(0.75)])
            .with_draw_order(order::SIGHT_OUTLINE);
        stream.log_static(entity::SIGHT_OUTLINE, &outline)?;
    }
    let class = |id: u8, label: &str, alpha| datatypes::AnnotationInfo {
        id: id.into(),
        label: Some(label.into()),
        color: Some(*scenery::colour(scenery::SENSOR, alpha)),
    };
    let classes = [class(0, "out of view", 0), class(IN_VIEW, "in view", 255)];
    stream.log_static(entity::SIGHT_CELLS, &AnnotationContext::new(classes))?;
    let picture = Picture::of_frame(&frame(sight, view.mapper.frame()));
    picture.log(stream, entity::SIGHT_CELLS, order::SIGHT, 0.2)
}

/// The field of view during a run.
pub(super) struct Track {
    outline: Rows<Strip>,
    cells: Rows<Classes>,
    /// Where the cells are that move with the robot.
    shift: Rows<Shift>,
    frame: GridFrame,
    due: Due,
    /// The classes and the place of the robot that were logged last.
    last: (Vec<u8>, Option<Cell>),
}

impl Track {
    pub(super) fn new(view: &View, pace: &Pace) -> Self {
        let map = view.mapper.frame();
        let frame = view.sight().map_or(*map, |sight| frame(sight, map));
        Self {
            outline: Rows::new(entity::SIGHT_OUTLINE),
            cells: Rows::new(entity::SIGHT_CELLS),
            shift: Rows::new(entity::SIGHT),
            due: Due::every(pace.picture(pace.sight, &frame)),
            frame,
            last: (Vec::new(), None),
        }
    }

    pub(super) fn push(&mut self, now: Now, view: &View, is_last: bool) {
        let Some(sight) = view.sight() else { return };
        if !(self.due.now(now.time) || is_last) {
            return;
        }
        match sight {
            Sight::Laser(reading) => {
                let corners = outline::field_of_view(reading);
                self.cells.push(now, [Classes(outline::fill(&corners, &self.frame, IN_VIEW))]);
                self.outline.push(now, [Strip(corners.iter().map(place).collect())]);
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
                    self.shift.push(now, [Shift(place(&map.center(robot)))]);
                    self.last.1 = Some(robot);
                }
            }
        }
    }

    pub(super) fn flush(&mut self, stream: &RecordingStream, unit: TimeUnit) -> Result<(), String> {
        self.shift.flush(stream, unit)?;
        self.cells.flush(stream, unit)?;
        self.outline.flush(stream, unit)
    }
}

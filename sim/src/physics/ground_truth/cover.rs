//! The cells that a body covers, completely or partly.

use super::convex_cells::convex_cells;
use crate::physics::form::Form;
use crate::physics::shape::{Rectangle, TOUCH_M};
use interfaces::{Cell, GridFrame};
use nalgebra::{Point2, Vector2};

/// Decides which cells a rectangle overlaps by more than a touch.
pub(super) struct BoxTest {
    shape: Rectangle,
    half_cell_m: f64,
    /// Half the extent of a cell along the sides of the rectangle, m.
    cell_reach_m: f64,
    /// Half the extent of the rectangle along those of the cell, m.
    reach: Vector2<f64>,
}

impl BoxTest {
    /// For the cells of `frame`.
    pub(super) fn new(frame: &GridFrame, shape: &Rectangle) -> Self {
        let half_cell_m = frame.resolution_m() / 2.0;
        let (low, high) = shape.bounds();
        let (cos, sin) = (shape.pose.rotation.re.abs(), shape.pose.rotation.im.abs());
        Self {
            shape: *shape,
            half_cell_m,
            cell_reach_m: half_cell_m * (cos + sin),
            reach: (high - low) / 2.0,
        }
    }

    /// Whether the rectangle covers the whole cell with this center; `None` if it does not overlap the cell.
    pub(super) fn covers(&self, center: &Point2<f64>) -> Option<bool> {
        let apart = (center - self.shape.pose.translation.vector).coords.abs();
        let local = self.shape.pose.inverse_transform_point(center).coords.abs();
        let overlap = |distance: &Vector2<f64>, reach: Vector2<f64>| (reach - distance).min() > TOUCH_M;
        let meets = overlap(&apart, self.reach.add_scalar(self.half_cell_m))
            && overlap(&local, self.shape.half_m.add_scalar(self.cell_reach_m));
        meets.then(|| (self.shape.half_m - local).min() >= self.cell_reach_m - TOUCH_M)
    }
}

/// Calls `visit` with the index of every cell of the frame that a rectangle overlaps by more than a touch, and whether the
/// rectangle covers the whole cell. Row by row from the bottom.
pub(in crate::physics) fn box_cells(
    frame: &GridFrame,
    shape: &Rectangle,
    mut visit: impl FnMut(usize, bool),
) {
    let ((low, high), test) = (shape.bounds(), BoxTest::new(frame, shape));
    for_cells(frame, &low, &high, |cell, index| {
        if let Some(whole) = test.covers(&frame.center(cell)) {
            visit(index, whole);
        }
    });
}

/// Calls `visit` with the cells that the body of a robot overlaps, like [`box_cells`].
pub(in crate::physics) fn form_cells(frame: &GridFrame, form: &Form, visit: impl FnMut(usize, bool)) {
    match form {
        Form::Disc { center, radius_m } => disc_cells(frame, center, *radius_m, visit),
        Form::Convex(corners) => convex_cells(frame, corners, visit),
    }
}

/// Calls `visit` with the cells that a disc overlaps, like [`box_cells`].
fn disc_cells(frame: &GridFrame, center: &Point2<f64>, radius_m: f64, mut visit: impl FnMut(usize, bool)) {
    let half_cell_m = frame.resolution_m() / 2.0;
    let reach = Vector2::repeat(radius_m);
    let (inner2, outer2) = ((radius_m - TOUCH_M).max(0.0).powi(2), (radius_m + TOUCH_M).powi(2));
    for_cells(frame, &(center - reach), &(center + reach), |cell, index| {
        let apart = (frame.center(cell) - center).abs();
        let nearest = apart.add_scalar(-half_cell_m).sup(&Vector2::zeros());
        if nearest.norm_squared() < inner2 {
            visit(index, apart.add_scalar(half_cell_m).norm_squared() <= outer2);
        }
    });
}

/// Calls `visit` with the cells of the frame that lie in an upright box and their indices, row by row.
fn for_cells(frame: &GridFrame, low: &Point2<f64>, high: &Point2<f64>, mut visit: impl FnMut(Cell, usize)) {
    let (first, last) = (frame.cell_at(low), frame.cell_at(high));
    let (right, top) = (frame.width() as i32 - 1, frame.height() as i32 - 1);
    for y in first.y.max(0)..=last.y.min(top) {
        for x in first.x.max(0)..=last.x.min(right) {
            visit(Cell::new(x, y), y as usize * frame.width() + x as usize);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> GridFrame {
        GridFrame::new(Point2::new(-1.0, -1.0), 0.05, 40, 40).unwrap()
    }

    #[test]
    fn a_wall_on_cell_borders_covers_whole_cells_only() {
        let wall = Rectangle::between(Point2::new(0.1, -0.35), Point2::new(0.2, 0.65));
        let mut cells = Vec::new();
        box_cells(&frame(), &wall, |index, whole| cells.push((frame().cell(index), whole)));
        assert_eq!(cells.len(), 2 * 20);
        assert!(cells.iter().all(|(cell, whole)| *whole && (22..24).contains(&cell.x)));
    }
}

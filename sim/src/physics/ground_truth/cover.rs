//! The cells that a body covers, completely or partly.

use crate::physics::convex;
use crate::physics::form::{Form, bounds};
use crate::physics::shape::{Rectangle, TOUCH_M};
use interfaces::{Cell, GridFrame};
use nalgebra::{Point2, Vector2};

/// Decides how cells lie to a rectangle.
#[derive(Clone, Copy)]
pub(super) struct BoxTest {
    pub(super) shape: Rectangle,
    half_cell_m: f64,
    /// Half the extent of a cell along the sides of the rectangle, m.
    cell_reach_m: f64,
    /// Half the extent of the rectangle along those of the cell, m.
    reach: Vector2<f64>,
}

/// How a rectangle lies to a cell.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Relation {
    /// The rectangle and the cell are apart.
    Apart,
    /// The rectangle covers the cell.
    Covers,
    /// Anything else, and where rounding could decide.
    Meets,
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

    /// Whether the rectangle covers the whole cell with this center, up to a touch; `None` if it does not overlap the cell.
    pub(super) fn covers(&self, center: &Point2<f64>) -> Option<bool> {
        let apart = (center - self.shape.pose.translation.vector).coords.abs();
        let local = self.shape.pose.inverse_transform_point(center).coords.abs();
        let overlap = |distance: &Vector2<f64>, reach: Vector2<f64>| (reach - distance).min() > TOUCH_M;
        let meets = overlap(&apart, self.reach.add_scalar(self.half_cell_m))
            && overlap(&local, self.shape.half_m.add_scalar(self.cell_reach_m));
        meets.then(|| (self.shape.half_m - local).min() >= self.cell_reach_m - TOUCH_M)
    }

    /// How the cell with this center lies to the rectangle.
    pub(super) fn relation(&self, center: &Point2<f64>) -> Relation {
        let apart = (center - self.shape.pose.translation.vector).coords.abs();
        if (apart - self.reach).max() > self.half_cell_m + TOUCH_M {
            return Relation::Apart;
        }
        let local = self.shape.pose.inverse_transform_point(center).coords.abs();
        let outside_m = local - self.shape.half_m;
        if outside_m.max() > self.cell_reach_m + TOUCH_M {
            Relation::Apart
        } else if outside_m.max() < -self.cell_reach_m - TOUCH_M {
            Relation::Covers
        } else {
            Relation::Meets
        }
    }
}

/// Calls `visit` with the index of every cell of the frame that a rectangle overlaps by more than a touch, and whether the
/// rectangle covers the whole cell. Row by row from the bottom.
pub(crate) fn box_cells(frame: &GridFrame, shape: &Rectangle, mut visit: impl FnMut(usize, bool)) {
    let ((low, high), test) = (shape.bounds(), BoxTest::new(frame, shape));
    for_cells(frame, &low, &high, |cell, index| {
        if let Some(whole) = test.covers(&frame.center(cell)) {
            visit(index, whole);
        }
    });
}

/// Calls `visit` with the cells that the body of a robot overlaps, like [`box_cells`].
pub(crate) fn form_cells(frame: &GridFrame, form: &Form, visit: impl FnMut(usize, bool)) {
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

/// Calls `visit` with the cells that a convex body overlaps, like [`box_cells`]. Two convex bodies are apart where a line
/// along a side of one of them separates them.
fn convex_cells(frame: &GridFrame, corners: &[Point2<f64>], mut visit: impl FnMut(usize, bool)) {
    let half_cell_m = frame.resolution_m() / 2.0;
    let (low, high) = bounds(corners);
    // For each side its normal, pointing outwards, a point on it, and half the extent of a cell across it, m.
    let sides: Vec<(Vector2<f64>, &Point2<f64>, f64)> = convex::sides(corners)
        .map(|(from, to)| {
            let along = (to - from).normalize();
            (Vector2::new(along.y, -along.x), from, half_cell_m * (along.x.abs() + along.y.abs()))
        })
        .collect();
    for_cells(frame, &low, &high, |cell, index| {
        let center = frame.center(cell);
        let (mut gap_m, mut uncovered_m) =
            ((low - center).sup(&(center - high)).max() - half_cell_m, f64::MIN);
        for (normal, from, reach_m) in &sides {
            let outside_m = normal.dot(&(center - *from));
            (gap_m, uncovered_m) = (gap_m.max(outside_m - reach_m), uncovered_m.max(outside_m + reach_m));
        }
        if gap_m < -TOUCH_M {
            visit(index, uncovered_m < TOUCH_M);
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
    use proptest::prelude::*;

    fn frame() -> GridFrame {
        GridFrame::new(Point2::new(-1.0, -1.0), 0.05, 40, 40).unwrap()
    }

    /// Whether a convex body covers the whole cell; `None` if it does not overlap the cell by more than a touch.
    fn covers_cell(corners: &[Point2<f64>], frame: &GridFrame, cell: Cell) -> Option<bool> {
        let half_m = frame.resolution_m() / 2.0;
        let corner = |(x, y): (f64, f64)| frame.center(cell) + Vector2::new(x, y) * half_m;
        let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner);
        (convex::gap_m(corners, &square) < -TOUCH_M).then(|| {
            let is_in = |corner: &Point2<f64>| convex::disc_gap_m(corners, corner, 0.0) < TOUCH_M;
            square.iter().all(is_in)
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]

        /// The reference compares every cell with all sides. The bodies have corners on an ellipse, or on the lines
        /// between cells, also beyond the border of the frame.
        #[test]
        fn cells_are_those_of_a_comparison_with_all_sides(
            x in -1.1..1.1, y in -1.1..1.1, width_m in 0.02..0.5, height_m in 0.02..0.5, heading_rad in -4.0..4.0,
            count in 3..24_u32, is_square: bool,
        ) {
            let corners: Vec<Point2<f64>> = if is_square {
                let on_line = |value: f64| (value * 20.0).round() / 20.0;
                let (low, high) = (Point2::new(on_line(x), on_line(y)), Point2::new(x + width_m, y + height_m));
                let high = high.map(on_line).sup(&low.map(|low| low + 0.05));
                vec![low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y)]
            } else {
                let pose = interfaces::pose(x, y, heading_rad);
                let corner = |i: u32| {
                    let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(count));
                    pose * Point2::new(width_m * cos, height_m * sin)
                };
                (0..count).map(corner).collect()
            };
            let frame = frame();
            let mut found = Vec::new();
            convex_cells(&frame, &corners, |index, whole| found.push((index, whole)));
            let all = (0..frame.len()).filter_map(|index| Some((index, covers_cell(&corners, &frame, frame.cell(index))?)));
            prop_assert_eq!(found, all.collect::<Vec<_>>());
        }
    }
}

//! The cells that a body covers, completely or partly.

use crate::physics::convex;
use crate::physics::form::Form;
use crate::physics::shape::{Rectangle, TOUCH_M};
use interfaces::{Cell, GridFrame};
use nalgebra::{Point2, Vector2};

/// A smaller share of the area of a cell than this is rounding.
const SLIVER: f64 = 1e-6;

/// Calls `visit` with the index of every cell of the frame that a rectangle overlaps by more than a touch, and whether the
/// rectangle covers the whole cell. Row by row from the bottom.
pub(in crate::physics) fn box_cells(
    frame: &GridFrame,
    shape: &Rectangle,
    mut visit: impl FnMut(usize, bool),
) {
    let half_cell_m = frame.resolution_m() / 2.0;
    let (low, high) = shape.bounds();
    let (cos, sin) = (shape.pose.rotation.re.abs(), shape.pose.rotation.im.abs());
    // Half the extent of the cell along the sides of the rectangle, and of the rectangle along those of the cell.
    let cell_reach_m = half_cell_m * (cos + sin);
    let reach = (high - low) / 2.0;
    for_cells(frame, &low, &high, |cell, index| {
        let center = frame.center(cell);
        let apart = (center - shape.pose.translation.vector).coords.abs();
        let local = shape.pose.inverse_transform_point(&center).coords.abs();
        let overlap = |distance: &Vector2<f64>, reach: Vector2<f64>| (reach - distance).min() > TOUCH_M;
        let meets = overlap(&apart, reach.add_scalar(half_cell_m))
            && overlap(&local, shape.half_m.add_scalar(cell_reach_m));
        if meets {
            visit(index, (shape.half_m - local).min() >= cell_reach_m - TOUCH_M);
        }
    });
}

/// Calls `visit` with the cells that the body of a robot overlaps, like [`box_cells`].
pub(in crate::physics) fn form_cells(frame: &GridFrame, form: &Form, visit: impl FnMut(usize, bool)) {
    match form {
        Form::Disc { center, radius_m } => disc_cells(frame, center, *radius_m, visit),
        Form::Convex(corners) => convex_cells(frame, form, corners, visit),
    }
}

fn convex_cells(frame: &GridFrame, form: &Form, corners: &[Point2<f64>], mut visit: impl FnMut(usize, bool)) {
    let (half_m, (low, high)) = (frame.resolution_m() / 2.0, form.bounds());
    for_cells(frame, &low, &high, |cell, index| {
        let corner = |(x, y): (f64, f64)| frame.center(cell) + Vector2::new(x, y) * half_m;
        let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner);
        if convex::gap_m(corners, &square) < -TOUCH_M {
            let is_in = |corner: &Point2<f64>| convex::disc_gap_m(corners, corner, 0.0) < TOUCH_M;
            visit(index, square.iter().all(is_in));
        }
    });
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

/// The share of a cell that none of the rectangles covers.
pub(super) fn open_share<'a>(
    frame: &GridFrame,
    cell: Cell,
    boxes: impl Iterator<Item = &'a Rectangle>,
) -> f64 {
    let (center, half_m) = (frame.center(cell), frame.resolution_m() / 2.0);
    let corner = |x: f64, y: f64| center + Vector2::new(x, y) * half_m;
    let square = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let mut open = vec![square];
    for shape in boxes {
        let sides = shape.corners();
        let mut rest = Vec::new();
        for mut inside in open {
            // Cut off the part outside of each side in turn; the rest at the end is covered.
            for i in 0..4 {
                let (p, q) = (sides[i], sides[(i + 1) % 4]);
                let outside = clip(&inside, &q, &p);
                if area(&outside) > 0.0 {
                    rest.push(outside);
                }
                inside = clip(&inside, &p, &q);
            }
        }
        open = rest;
    }
    let share = open.iter().map(|piece| area(piece)).sum::<f64>() / (4.0 * half_m * half_m);
    if share < SLIVER { 0.0 } else { share.min(1.0) }
}

/// The part of a convex polygon on the left of the line from `p` to `q` (Sutherland–Hodgman).
fn clip(polygon: &[Point2<f64>], p: &Point2<f64>, q: &Point2<f64>) -> Vec<Point2<f64>> {
    let left = |point: &Point2<f64>| (q - p).perp(&(point - p));
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, a) in polygon.iter().enumerate() {
        let b = &polygon[(i + 1) % polygon.len()];
        let (at_a, at_b) = (left(a), left(b));
        if at_a >= 0.0 {
            kept.push(*a);
        }
        if at_a * at_b < 0.0 {
            kept.push(a + (b - a) * (at_a / (at_a - at_b)));
        }
    }
    kept
}

/// The area of a counter-clockwise polygon, m².
fn area(polygon: &[Point2<f64>]) -> f64 {
    let Some(first) = polygon.first() else { return 0.0 };
    // Relative to one of its corners, so that nothing is lost far from the origin.
    polygon.windows(2).map(|pair| (pair[0] - first).perp(&(pair[1] - first))).sum::<f64>() / 2.0
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

    #[test]
    fn two_halves_make_a_whole() {
        let cell = Cell::new(20, 20);
        let left = Rectangle::between(Point2::new(-0.1, -0.1), Point2::new(0.02, 0.1));
        let right = Rectangle::between(Point2::new(0.02, -0.1), Point2::new(0.1, 0.1));
        assert!((open_share(&frame(), cell, [left].iter()) - 0.6).abs() < 1e-9);
        assert_eq!(open_share(&frame(), cell, [left, right].iter()), 0.0);
        assert_eq!(open_share(&frame(), cell, [].iter()), 1.0);
    }
}

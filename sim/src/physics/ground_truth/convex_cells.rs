//! The cells that a convex body covers, completely or partly.
//!
//! From where the sides of the body cross the lines between the rows of cells follows which columns the body certainly
//! meets or covers. Only where rounding could decide, a cell is compared with all sides.

use crate::physics::convex;
use crate::physics::shape::TOUCH_M;
use interfaces::{Cell, GridFrame};
use nalgebra::{Point2, Vector2};
use std::ops::Range;

/// A result is certain if it is the same for a cell with its borders this much farther in or out, m: far above
/// [`TOUCH_M`] and rounding.
const CERTAIN_M: f64 = 1e-5;

/// Calls `visit` with the index of every cell of the frame that a convex body overlaps by more than a touch, and
/// whether the body covers the whole cell. Row by row from the bottom.
pub(super) fn convex_cells(frame: &GridFrame, corners: &[Point2<f64>], mut visit: impl FnMut(usize, bool)) {
    let Rows { first, lines } = Rows::new(frame, corners);
    let height = frame.height() as i32;
    for (row, pair) in (first..).zip(lines.windows(2)).filter(|(row, _)| (0..height).contains(row)) {
        let [below, above] = [&pair[0], &pair[1]];
        // With the borders of the cells farther in, and farther out.
        let met_inside = below.inner.and(&below.upper).and(&above.lower);
        let met_outside = below.outer.and(&below.lower).and(&above.upper);
        let meets = met_inside.columns_that_meet(frame, -CERTAIN_M);
        let covers = below.lower.common(&above.upper).columns_within(frame, CERTAIN_M);
        let may_cover = below.upper.common(&above.lower).columns_within(frame, -CERTAIN_M);
        for x in met_outside.columns_that_meet(frame, CERTAIN_M) {
            let whole = covers.contains(&x);
            let whole = if meets.contains(&x) && (whole || !may_cover.contains(&x)) {
                Some(whole)
            } else {
                covers_cell(corners, frame, Cell::new(x, row))
            };
            if let Some(whole) = whole {
                visit(row as usize * frame.width() + x as usize, whole);
            }
        }
    }
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

/// From where to where a body reaches along x, m.
#[derive(Clone, Copy)]
struct Extent {
    low_m: f64,
    high_m: f64,
}

impl Extent {
    const NONE: Self = Self { low_m: f64::INFINITY, high_m: f64::NEG_INFINITY };

    fn add(&mut self, x_m: f64) {
        (self.low_m, self.high_m) = (self.low_m.min(x_m), self.high_m.max(x_m));
    }

    fn and(&self, other: &Self) -> Self {
        Self { low_m: self.low_m.min(other.low_m), high_m: self.high_m.max(other.high_m) }
    }

    fn common(&self, other: &Self) -> Self {
        Self { low_m: self.low_m.max(other.low_m), high_m: self.high_m.min(other.high_m) }
    }

    /// The columns of the frame whose cells reach into the extent, if each is wider by `border_m` on both sides.
    fn columns_that_meet(&self, frame: &GridFrame, border_m: f64) -> Range<i32> {
        let end = column(frame, self.high_m + border_m).saturating_add(1);
        column(frame, self.low_m - border_m).max(0)..end.min(frame.width() as i32)
    }

    /// The columns whose cells lie in the extent, if each is wider by `border_m` on both sides.
    fn columns_within(&self, frame: &GridFrame, border_m: f64) -> Range<i32> {
        column(frame, self.low_m + border_m).saturating_add(1)..column(frame, self.high_m - border_m)
    }
}

/// The column at a place along x, but for rounding.
fn column(frame: &GridFrame, x_m: f64) -> i32 {
    floor((x_m - frame.origin().x) / frame.resolution_m())
}

/// The row at a place along y, but for rounding.
fn row(frame: &GridFrame, y_m: f64) -> i32 {
    floor((y_m - frame.origin().y) / frame.resolution_m())
}

/// The largest whole number that is not above a number, limited to the range of `i32`.
fn floor(value: f64) -> i32 {
    let toward_zero = value as i32;
    toward_zero.saturating_sub(i32::from(value < f64::from(toward_zero)))
}

/// A line between two rows of cells, and the row above it.
#[derive(Clone, Copy)]
struct Line {
    /// The extents of the body a little below the line, and a little above it.
    lower: Extent,
    upper: Extent,
    /// The corners of the body in the row, with its borders farther in, and farther out.
    inner: Extent,
    outer: Extent,
}

/// A body on the lines between rows of cells.
struct Rows {
    /// The row above the first line.
    first: i32,
    lines: Vec<Line>,
}

impl Rows {
    fn new(frame: &GridFrame, corners: &[Point2<f64>]) -> Self {
        let ys_m = || corners.iter().map(|corner| corner.y);
        let (low_m, high_m) =
            (ys_m().fold(f64::INFINITY, f64::min), ys_m().fold(f64::NEG_INFINITY, f64::max));
        // A corner may lie right beside a line.
        let first = row(frame, low_m - CERTAIN_M);
        let lines = row(frame, high_m + CERTAIN_M).saturating_sub(first).max(0) as usize + 2;
        let none = Extent::NONE;
        let line = Line { lower: none, upper: none, inner: none, outer: none };
        let mut rows = Self { first, lines: vec![line; lines] };
        for (from, to) in convex::sides(corners) {
            rows.add_corner(frame, from);
            rows.add_side(frame, from, to);
        }
        rows
    }

    /// The y coordinate of a line, m.
    fn y_m(&self, frame: &GridFrame, line: usize) -> f64 {
        frame.origin().y + (f64::from(self.first) + line as f64) * frame.resolution_m()
    }

    /// The lines below two points, the lower one first.
    fn lines_below(&self, frame: &GridFrame, low_m: f64, high_m: f64) -> Range<usize> {
        let line = |y_m: f64| (row(frame, y_m) - self.first).max(0) as usize;
        line(low_m)..line(high_m) + 1
    }

    fn add_corner(&mut self, frame: &GridFrame, corner: &Point2<f64>) {
        for line in self.lines_below(frame, corner.y - CERTAIN_M, corner.y + CERTAIN_M) {
            let (low_m, high_m) = (self.y_m(frame, line), self.y_m(frame, line + 1));
            self.lines[line].outer.add(corner.x);
            if corner.y > low_m + CERTAIN_M && corner.y < high_m - CERTAIN_M {
                self.lines[line].inner.add(corner.x);
            }
        }
    }

    fn add_side(&mut self, frame: &GridFrame, from: &Point2<f64>, to: &Point2<f64>) {
        let (bottom, top) = if from.y <= to.y { (from, to) } else { (to, from) };
        let slope = (top.x - bottom.x) / (top.y - bottom.y);
        for line in self.lines_below(frame, bottom.y - CERTAIN_M, top.y + CERTAIN_M) {
            let y_m = self.y_m(frame, line);
            let Line { lower, upper, .. } = &mut self.lines[line];
            for (y_m, extent) in [(y_m - CERTAIN_M, lower), (y_m + CERTAIN_M, upper)] {
                if (bottom.y..top.y).contains(&y_m) {
                    extent.add(bottom.x + (y_m - bottom.y) * slope);
                }
            }
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

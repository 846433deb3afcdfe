//! The state of a cell under rectangles that may overlap each other.

use super::cover::{BoxTest, Relation};
use crate::physics::convex::area;
use crate::physics::shape::Rectangle;
use interfaces::{Cell, GridFrame, TrueState};
use nalgebra::{Point2, Vector2};

/// A smaller share of the area of a cell than this is rounding.
const SLIVER: f64 = 1e-6;

/// Computes the states of cells under the same rectangles.
///
/// Most cells are far from all rectangles, or well within one of them. Only for the others the share of the cell
/// that no rectangle covers is computed.
pub(super) struct Cover {
    shapes: Vec<BoxTest>,
    share: OpenShare,
}

impl Cover {
    /// For cells of `frame` under `shapes`.
    pub(super) fn new(frame: &GridFrame, shapes: impl Iterator<Item = Rectangle>) -> Self {
        let shapes = shapes.map(|shape| BoxTest::new(frame, &shape));
        Self { shapes: shapes.collect(), share: OpenShare::default() }
    }

    /// The state of a cell.
    pub(super) fn state(&mut self, frame: &GridFrame, cell: Cell) -> TrueState {
        let center = frame.center(cell);
        let mut is_met = false;
        for shape in &self.shapes {
            match shape.relation(&center) {
                Relation::Covers => return TrueState::Blocked,
                Relation::Meets => is_met = true,
                Relation::Apart => {}
            }
        }
        if !is_met {
            return TrueState::Free;
        }
        let meeting = self.shapes.iter().filter(|shape| shape.relation(&center) == Relation::Meets);
        state_of(self.share.of(frame, cell, meeting.map(|shape| &shape.shape)))
    }
}

/// The state of a cell of which a share is not covered.
pub(super) fn state_of(open_share: f64) -> TrueState {
    match open_share {
        share if share <= 0.0 => TrueState::Blocked,
        share if share < 1.0 - 1e-6 => TrueState::PartlyCovered,
        _ => TrueState::Free,
    }
}

/// Computes the share of a cell that rectangles leave open; keeps its memory for the next cell.
#[derive(Default)]
pub(super) struct OpenShare {
    open: Pieces,
    rest: Pieces,
    inside: Vec<Point2<f64>>,
    cut: Vec<Point2<f64>>,
}

/// Convex polygons, one after the other.
#[derive(Default)]
struct Pieces {
    points: Vec<Point2<f64>>,
    /// The end of each polygon.
    ends: Vec<usize>,
}

impl Pieces {
    fn clear(&mut self) {
        self.points.clear();
        self.ends.clear();
    }

    fn iter(&self) -> impl Iterator<Item = &[Point2<f64>]> {
        let starts = [0].into_iter().chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.points[start..end])
    }
}

impl OpenShare {
    /// The share of a cell that none of the rectangles covers.
    pub(super) fn of<'a>(
        &mut self,
        frame: &GridFrame,
        cell: Cell,
        boxes: impl Iterator<Item = &'a Rectangle>,
    ) -> f64 {
        let Self { open, rest, inside, cut } = self;
        let (center, half_m) = (frame.center(cell), frame.resolution_m() / 2.0);
        let corner = |x: f64, y: f64| center + Vector2::new(x, y) * half_m;
        open.clear();
        open.points.extend([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
        open.ends.push(4);
        for shape in boxes {
            let sides = shape.corners();
            rest.clear();
            for piece in open.iter() {
                inside.clear();
                inside.extend_from_slice(piece);
                // Cut off the part outside of each side in turn; the rest at the end is covered.
                for i in 0..4 {
                    let (p, q) = (sides[i], sides[(i + 1) % 4]);
                    let start = rest.points.len();
                    clip(inside, &q, &p, &mut rest.points);
                    if area(&rest.points[start..]) > 0.0 {
                        rest.ends.push(rest.points.len());
                    } else {
                        rest.points.truncate(start);
                    }
                    cut.clear();
                    clip(inside, &p, &q, cut);
                    std::mem::swap(inside, cut);
                }
            }
            std::mem::swap(open, rest);
        }
        let share = open.iter().map(area).sum::<f64>() / (4.0 * half_m * half_m);
        if share < SLIVER { 0.0 } else { share.min(1.0) }
    }
}

/// Appends the part of a convex polygon on the left of the line from `p` to `q` (Sutherland–Hodgman).
fn clip(polygon: &[Point2<f64>], p: &Point2<f64>, q: &Point2<f64>, kept: &mut Vec<Point2<f64>>) {
    let left = |point: &Point2<f64>| (q - p).perp(&(point - p));
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn frame() -> GridFrame {
        GridFrame::new(Point2::new(-1.0, -1.0), 0.05, 40, 40).unwrap()
    }

    #[test]
    fn two_halves_make_a_whole() {
        let cell = Cell::new(20, 20);
        let left = Rectangle::between(Point2::new(-0.1, -0.1), Point2::new(0.02, 0.1));
        let right = Rectangle::between(Point2::new(0.02, -0.1), Point2::new(0.1, 0.1));
        let mut share = OpenShare::default();
        assert!((share.of(&frame(), cell, [left].iter()) - 0.6).abs() < 1e-9);
        assert_eq!(share.of(&frame(), cell, [left, right].iter()), 0.0);
        assert_eq!(share.of(&frame(), cell, [].iter()), 1.0);
    }

    prop_compose! {
        /// A rectangle at any angle, or with its sides on the borders of cells.
        fn rectangle()(
            x in -1.0..1.0, y in -1.0..1.0, width_m in 0.01..0.7, height_m in 0.01..0.7, heading_rad in -4.0..4.0,
            is_upright: bool,
        ) -> Rectangle {
            let on_border = |value: f64| if is_upright { (value * 20.0).round() / 20.0 } else { value };
            let low = Point2::new(on_border(x), on_border(y));
            let high = low + Vector2::new(on_border(width_m).max(0.05), on_border(height_m).max(0.05));
            let upright = Rectangle::between(low, high);
            let middle = upright.pose.translation.vector.into();
            if is_upright { upright } else { Rectangle::around(middle, high - low, heading_rad) }
        }
    }

    proptest! {
        /// The reference is the share that the rectangles leave open, for every cell.
        #[test]
        fn states_are_those_of_the_open_share(shapes in prop::collection::vec(rectangle(), 0..6)) {
            let (frame, mut share) = (frame(), OpenShare::default());
            let mut cover = Cover::new(&frame, shapes.iter().copied());
            for cell in (0..frame.len()).map(|index| frame.cell(index)) {
                let expected = state_of(share.of(&frame, cell, shapes.iter()));
                prop_assert_eq!(cover.state(&frame, cell), expected, "{:?}", cell);
            }
        }
    }
}

//! What can be seen from where, worked out once for walls that never move.
//!
//! The place is cut into square cells. For each cell there are two lists: the edges that some point
//! of the cell may see, and the cells in which a robot may be seen. Left out is what is too far,
//! what is turned away, and what one single edge hides from the whole cell: then every line of
//! sight crosses that edge. All margins are on the safe side, so leaving these out never changes a
//! range.

use super::lists::Lists;
use super::outline::Edge;
use crate::physics::shape::{Rectangle, point_segment_m};
use nalgebra::{Point2, Vector2};

/// The most cells: more would see less each, but cost more to work out.
const MAX_CELLS: f64 = 1024.0;
/// Smaller cells would be no better, m.
const LEAST_CELL_M: f64 = 1.0;
/// Only so many edges per cell are tried as what hides others: those that look largest from there.
const HIDERS: usize = 24;
/// Only edges at least as large as this from there, as length over distance.
const HIDER_SIZE: f64 = 0.1;
/// Points this near to a cell or an edge may count as on it, m.
const MARGIN_M: f64 = 1e-6;

/// How far the users of an index see, and how large what they see is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// The longest range of any laser, m.
    pub(super) range_m: f64,
    /// The largest radius of any robot, m.
    pub(super) radius_m: f64,
}

/// The cells and what can be seen from each.
#[derive(Clone, Debug)]
pub(super) struct Sight {
    low: Point2<f64>,
    cell_m: f64,
    columns: usize,
    rows: usize,
    edges: Lists,
    cells: Lists,
    /// The boxes that reach into each cell.
    boxes: Lists,
}

impl Sight {
    /// Works out the lists for everything between two corners (m).
    pub(super) fn new(
        low: Point2<f64>,
        high: Point2<f64>,
        boxes: &[Rectangle],
        edges: &[Edge],
        reach: &Reach,
    ) -> Self {
        let extent = high - low;
        let cell_m = (extent.x * extent.y / MAX_CELLS).sqrt().max(LEAST_CELL_M);
        let count = |length_m: f64| (length_m / cell_m) as usize + 1;
        let mut sight = Self {
            low,
            cell_m,
            columns: count(extent.x),
            rows: count(extent.y),
            edges: Lists::new(),
            cells: Lists::new(),
            boxes: Lists::new(),
        };
        let mut boxes_in = vec![Vec::new(); sight.len()];
        for (i, shape) in boxes.iter().enumerate() {
            let (low, high) = shape.bounds();
            for cell in sight.around(&low, &high) {
                boxes_in[cell].push(i as u32);
            }
        }
        for (cell, inside) in boxes_in.into_iter().enumerate() {
            let own = sight.square(cell, MARGIN_M);
            sight.boxes.push(inside.into_iter());
            let view = View::new(&own, edges, reach);
            sight.edges.push(view.edges(edges));
            let robots = (0..sight.len()).map(|i| sight.square(i, reach.radius_m + MARGIN_M));
            let visible = robots.enumerate().filter(|(_, square)| view.sees(square));
            let mut visible: Vec<u32> = visible.map(|(i, _)| i as u32).collect();
            // The nearest first: they hide the others.
            let apart_m = |&other: &u32| {
                let other = sight.square(other as usize, 0.0).pose.translation.vector;
                (other - own.pose.translation.vector).norm()
            };
            visible.sort_by(|a, b| apart_m(a).total_cmp(&apart_m(b)).then(a.cmp(b)));
            sight.cells.push(visible.into_iter());
        }
        sight
    }

    /// The number of cells.
    pub(super) fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// The cell in which a point lies; `None` beyond the borders.
    pub(super) fn cell_at(&self, point: &Point2<f64>) -> Option<usize> {
        let place = (point - self.low) / self.cell_m;
        if place.x >= 0.0 && place.y >= 0.0 {
            let (column, row) = (place.x as usize, place.y as usize);
            (column < self.columns && row < self.rows).then_some(row * self.columns + column)
        } else {
            None
        }
    }

    /// The edges that may be seen from a cell.
    pub(super) fn edges(&self, cell: usize) -> &[u32] {
        self.edges.get(cell)
    }

    /// The cells in which a robot may be seen from a cell, the nearest first.
    pub(super) fn cells(&self, cell: usize) -> &[u32] {
        self.cells.get(cell)
    }

    /// The boxes that reach into a cell.
    pub(super) fn boxes(&self, cell: usize) -> &[u32] {
        self.boxes.get(cell)
    }

    /// Whether the upright box between two corners (m) is not wholly within the borders.
    pub(super) fn reaches_out(&self, low: &Point2<f64>, high: &Point2<f64>) -> bool {
        let end = Vector2::new(self.columns as f64, self.rows as f64) * self.cell_m;
        (low - self.low).min() < MARGIN_M || (self.low + end - high).min() < MARGIN_M
    }

    /// The cells that the upright box between two corners (m) reaches into, and some beside it.
    pub(super) fn around(
        &self,
        low: &Point2<f64>,
        high: &Point2<f64>,
    ) -> impl Iterator<Item = usize> + use<> {
        let margin = Vector2::repeat(2.0 * MARGIN_M);
        let (first, last) =
            ((low - margin - self.low) / self.cell_m, (high + margin - self.low) / self.cell_m);
        // What lies below 0 becomes 0, and what lies beyond the end becomes the end.
        let (columns, rows) = (self.columns, self.rows);
        let place = move |at: Vector2<f64>| ((at.x as usize).min(columns - 1), (at.y as usize).min(rows - 1));
        let ((left, bottom), (right, top)) = (place(first), place(last));
        (bottom..=top).flat_map(move |row| (left..=right).map(move |column| row * columns + column))
    }

    /// A cell with a border around it.
    fn square(&self, cell: usize, border_m: f64) -> Rectangle {
        let place = Vector2::new((cell % self.columns) as f64, (cell / self.columns) as f64);
        let low = self.low + place * self.cell_m;
        let border = Vector2::repeat(border_m);
        Rectangle::between(low - border, low + Vector2::repeat(self.cell_m) + border)
    }
}

/// What may be seen from somewhere in a cell.
struct View {
    corners: [Point2<f64>; 4],
    middle: Point2<f64>,
    /// From the middle to a corner, m.
    half_m: f64,
    range_m: f64,
    /// The edges within the range of some point of the cell.
    near: Vec<usize>,
    hiders: Vec<Edge>,
}

impl View {
    fn new(cell: &Rectangle, edges: &[Edge], reach: &Reach) -> Self {
        let (middle, half_m) = (Point2::from(cell.pose.translation.vector), cell.half_m.norm());
        let far_m = reach.range_m + half_m + MARGIN_M;
        let is_near = |edge: &Edge| {
            let (along, to) = (edge.to - edge.from, middle - edge.from);
            // Beyond a circle around both: most are, and need no root.
            to.norm_squared() <= 2.0 * (far_m * far_m + along.norm_squared())
                && point_segment_m(&middle, &edge.from, &edge.to) <= far_m
        };
        let near: Vec<usize> = (0..edges.len()).filter(|&i| is_near(&edges[i])).collect();
        let mut hiders: Vec<(f64, usize)> = Vec::new();
        for &i in &near {
            let (edge, length_m) = (&edges[i], (edges[i].to - edges[i].from).norm());
            let size = length_m / (point_segment_m(&middle, &edge.from, &edge.to) + half_m);
            // What is smaller than half a cell hides next to nothing from all of it.
            if length_m > half_m && size > HIDER_SIZE {
                hiders.push((-size, i));
            }
        }
        hiders.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let hiders = hiders.into_iter().take(HIDERS).map(|(_, i)| edges[i]).collect();
        Self { corners: cell.corners(), middle, half_m, range_m: reach.range_m, near, hiders }
    }

    /// The edges that may be seen.
    fn edges(&self, edges: &[Edge]) -> impl Iterator<Item = u32> {
        let is_seen = |edge: &Edge| {
            self.corners.iter().any(|corner| edge.gap_m(corner) > 0.0)
                && !self.is_hidden(&[edge.from, edge.to])
        };
        self.near.iter().filter(move |&&i| is_seen(&edges[i])).map(|&i| i as u32)
    }

    /// Whether some point of a square may be seen.
    fn sees(&self, square: &Rectangle) -> bool {
        let apart_m: f64 = (square.pose.translation.vector - self.middle.coords).norm();
        apart_m - square.half_m.norm() <= self.range_m + self.half_m + MARGIN_M
            && !self.is_hidden(&square.corners())
    }

    /// Whether one edge crosses every line of sight from the cell to the convex hull of `points`.
    fn is_hidden(&self, points: &[Point2<f64>]) -> bool {
        self.hiders.iter().any(|hider| {
            let gap_m = hider.gap_m(&self.corners[0]);
            if gap_m.abs() < MARGIN_M {
                return false;
            }
            // +1: the cell is outside of the hider's line.
            let side = gap_m.signum();
            self.corners.iter().all(|corner| hider.gap_m(corner) * side > MARGIN_M)
                && points.iter().all(|point| hider.gap_m(point) * side < -MARGIN_M)
                && self.corners.iter().all(|corner| points.iter().all(|point| crosses(corner, point, hider)))
        })
    }
}

/// Whether the line of sight from `a` to `b`, whose ends lie on both sides of the line of `hider`,
/// passes between the ends of that by more than a margin.
fn crosses(a: &Point2<f64>, b: &Point2<f64>, hider: &Edge) -> bool {
    let along = b - a;
    let least = MARGIN_M * along.norm();
    let (from, to) = (along.perp(&(hider.from - a)), along.perp(&(hider.to - a)));
    from > least && to < -least || from < -least && to > least
}

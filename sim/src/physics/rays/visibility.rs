//! A potentially visible set (Airey et al., 1990) of walls that never move.
//!
//! The world is divided into square cells. Each cell has two lists: the edges that may be visible from some
//! point of the cell, and the cells in which a robot may be visible. The lists leave out what is too far away,
//! what faces away, and what one single edge hides from the whole cell (every line of sight then crosses that
//! edge). All margins are on the safe side, so the lists never change a range.

use super::edges::Edge;
use super::hiding::{SeenEdge, sectors_of};
use super::index_lists::IndexLists;
use crate::physics::shape::{Rectangle, point_segment_m};
use nalgebra::{Point2, Vector2};
use std::f64::consts::SQRT_2;

/// The largest number of cells: more cells would have shorter lists, but take longer to compute.
const MAX_CELLS: f64 = 1024.0;
/// The smallest cell, m: smaller cells would not be better.
const MIN_CELL_M: f64 = 1.0;
/// The number of edges per cell that are tested as occluders: those that look largest from the cell.
const MAX_OCCLUDERS: usize = 24;
/// The smallest occluder as seen from the cell, as length over distance.
const MIN_OCCLUDER_SIZE: f64 = 0.1;
/// Points this near to a cell or an edge may count as being on it, m.
const MARGIN_M: f64 = 1e-6;

/// The cells, and what can be seen from each.
#[derive(Clone, Debug)]
pub(super) struct PotentiallyVisibleSet {
    low: Point2<f64>,
    cell_m: f64,
    columns: usize,
    rows: usize,
    /// The column and the row of each cell.
    places: Vec<[u16; 2]>,
    /// The largest radius of any robot, m.
    radius_m: f64,
    /// The edges that may be seen from each cell, the nearest first.
    pub(super) edges: IndexLists<SeenEdge>,
    /// The cells in which a robot may be seen from each cell, the nearest first.
    pub(super) cells: IndexLists,
    /// The rectangles that overlap each cell.
    pub(super) boxes: IndexLists,
}

impl PotentiallyVisibleSet {
    /// Computes the lists for the world between two corners (m). `range_m` is the longest range of any laser, and
    /// `radius_m` the largest radius of any robot.
    pub(super) fn new(
        low: Point2<f64>,
        high: Point2<f64>,
        boxes: &[Rectangle],
        edges: &[Edge],
        range_m: f64,
        radius_m: f64,
    ) -> Self {
        let extent = high - low;
        let cell_m = (extent.x * extent.y / MAX_CELLS).sqrt().max(MIN_CELL_M);
        let count = |length_m: f64| (length_m / cell_m) as usize + 1;
        let mut set = Self {
            low,
            cell_m,
            columns: count(extent.x),
            rows: count(extent.y),
            places: Vec::new(),
            radius_m,
            edges: IndexLists::default(),
            cells: IndexLists::default(),
            boxes: IndexLists::default(),
        };
        set.places = (0..set.len()).map(|cell| set.place(cell).map(|index| index as u16)).collect();
        let mut boxes_in = vec![Vec::new(); set.len()];
        for (i, shape) in boxes.iter().enumerate() {
            let (low, high) = shape.bounds();
            for cell in set.around(&low, &high) {
                boxes_in[cell].push(i as u32);
            }
        }
        for (cell, inside) in boxes_in.into_iter().enumerate() {
            let own = set.square(cell, MARGIN_M);
            set.boxes.push(inside.into_iter());
            let view = View::new(&own, edges, range_m);
            set.edges.push(view.edges(edges).into_iter());
            let robots = (0..set.len()).map(|i| set.square(i, radius_m + MARGIN_M));
            let visible = robots.enumerate().filter(|(_, square)| view.sees(square));
            let mut visible: Vec<u32> = visible.map(|(i, _)| i as u32).collect();
            // The nearest cells first: robots in them hide others.
            let apart_m = |&other: &u32| {
                let other = set.square(other as usize, 0.0).pose.translation.vector;
                (other - own.pose.translation.vector).norm()
            };
            visible.sort_by(|a, b| apart_m(a).total_cmp(&apart_m(b)).then(a.cmp(b)));
            set.cells.push(visible.into_iter());
        }
        set
    }

    /// The number of cells.
    pub(super) fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// The cell in which a point lies; `None` beyond the borders.
    pub(super) fn cell_at(&self, point: &Point2<f64>) -> Option<usize> {
        let at = (point - self.low) / self.cell_m;
        if at.x >= 0.0 && at.y >= 0.0 {
            let (column, row) = (at.x as usize, at.y as usize);
            (column < self.columns && row < self.rows).then_some(row * self.columns + column)
        } else {
            None
        }
    }

    /// At most the shortest distance between a point of one cell and a robot with its center in the other one, or a
    /// part of a body that lies in the other one, m.
    pub(super) fn apart_m(&self, cell: usize, other: usize) -> f64 {
        let ([x, y], [other_x, other_y]) = (self.places[cell], self.places[other]);
        let cells = Vector2::new(x.abs_diff(other_x), y.abs_diff(other_y)).cast::<f64>().norm();
        (cells - SQRT_2) * self.cell_m - self.radius_m - MARGIN_M
    }

    /// The column and the row of a cell.
    fn place(&self, cell: usize) -> [usize; 2] {
        [cell % self.columns, cell / self.columns]
    }

    /// Whether the upright box between two corners (m) is not wholly within the borders.
    pub(super) fn reaches_out(&self, low: &Point2<f64>, high: &Point2<f64>) -> bool {
        let end = Vector2::new(self.columns as f64, self.rows as f64) * self.cell_m;
        (low - self.low).min() < MARGIN_M || (self.low + end - high).min() < MARGIN_M
    }

    /// The cells that the upright box between two corners (m) overlaps, and some beside the box.
    pub(super) fn around(
        &self,
        low: &Point2<f64>,
        high: &Point2<f64>,
    ) -> impl Iterator<Item = usize> + use<> {
        let margin = Vector2::repeat(2.0 * MARGIN_M);
        let (first, last) =
            ((low - margin - self.low) / self.cell_m, (high + margin - self.low) / self.cell_m);
        // Indices below 0 become 0, and indices beyond the end become the last one.
        let (columns, rows) = (self.columns, self.rows);
        let index = move |at: Vector2<f64>| ((at.x as usize).min(columns - 1), (at.y as usize).min(rows - 1));
        let ((left, bottom), (right, top)) = (index(first), index(last));
        (bottom..=top).flat_map(move |row| (left..=right).map(move |column| row * columns + column))
    }

    /// A cell with a border around it.
    fn square(&self, cell: usize, border_m: f64) -> Rectangle {
        let index = Vector2::from(self.place(cell).map(|index| index as f64));
        let low = self.low + index * self.cell_m;
        let border = Vector2::repeat(border_m);
        Rectangle::between(low - border, low + Vector2::repeat(self.cell_m) + border)
    }
}

/// What may be visible from some point of a cell.
struct View {
    corners: [Point2<f64>; 4],
    middle: Point2<f64>,
    /// From the middle to a corner, m.
    half_m: f64,
    range_m: f64,
    /// The edges within the range of some point of the cell, with their distances from the middle, m.
    near: Vec<(usize, f64)>,
    occluders: Vec<Edge>,
}

impl View {
    fn new(cell: &Rectangle, edges: &[Edge], range_m: f64) -> Self {
        let (middle, half_m) = (Point2::from(cell.pose.translation.vector), cell.half_m.norm());
        let far_m = range_m + half_m + MARGIN_M;
        let near_m = |edge: &Edge| {
            let (along, to) = (edge.to - edge.from, middle - edge.from);
            // Most edges lie beyond a circle around the edge and the cell: the test needs no root.
            let may_be_near = to.norm_squared() <= 2.0 * (far_m * far_m + along.norm_squared());
            may_be_near.then(|| point_segment_m(&middle, &edge.from, &edge.to)).filter(|m| *m <= far_m)
        };
        let near: Vec<(usize, f64)> =
            edges.iter().enumerate().filter_map(|(i, edge)| Some((i, near_m(edge)?))).collect();
        let mut occluders: Vec<(f64, usize)> = Vec::new();
        for &(i, distance_m) in &near {
            let length_m = (edges[i].to - edges[i].from).norm();
            let size = length_m / (distance_m + half_m);
            // An edge smaller than half a cell hides almost nothing from the whole cell.
            if length_m > half_m && size > MIN_OCCLUDER_SIZE {
                occluders.push((-size, i));
            }
        }
        occluders.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let occluders = occluders.into_iter().take(MAX_OCCLUDERS).map(|(_, i)| edges[i]).collect();
        Self { corners: cell.corners(), middle, half_m, range_m, near, occluders }
    }

    /// The edges that may be seen, the nearest first.
    fn edges(&self, edges: &[Edge]) -> Vec<SeenEdge> {
        let is_seen = |edge: &Edge| {
            self.corners.iter().any(|corner| edge.gap_m(corner) > 0.0)
                && !self.is_hidden(&[edge.from, edge.to])
        };
        let seen = self.near.iter().filter(|(i, _)| is_seen(&edges[*i]));
        let mut seen: Vec<SeenEdge> = seen
            .map(|&(i, middle_m)| {
                // Less than the true value, also in single precision.
                let nearest_m = (middle_m - self.half_m - MARGIN_M) as f32 - 1e-5 * middle_m as f32;
                SeenEdge { edge: i as u32, nearest_m, sectors: sectors_of(&self.corners, &edges[i]) }
            })
            .collect();
        seen.sort_unstable_by(|a, b| a.nearest_m.total_cmp(&b.nearest_m).then(a.edge.cmp(&b.edge)));
        seen
    }

    /// Whether some point of a square may be seen.
    fn sees(&self, square: &Rectangle) -> bool {
        let apart_m: f64 = (square.pose.translation.vector - self.middle.coords).norm();
        apart_m - square.half_m.norm() <= self.range_m + self.half_m + MARGIN_M
            && !self.is_hidden(&square.corners())
    }

    /// Whether one edge crosses every line of sight from the cell to the convex hull of `points`.
    fn is_hidden(&self, points: &[Point2<f64>]) -> bool {
        self.occluders.iter().any(|occluder| {
            let gap_m = occluder.gap_m(&self.corners[0]);
            if gap_m.abs() < MARGIN_M {
                return false;
            }
            // +1: the cell is on the outside of the line of the occluder.
            let side = gap_m.signum();
            self.corners.iter().all(|corner| occluder.gap_m(corner) * side > MARGIN_M)
                && points.iter().all(|point| occluder.gap_m(point) * side < -MARGIN_M)
                && self
                    .corners
                    .iter()
                    .all(|corner| points.iter().all(|point| crosses(corner, point, occluder)))
        })
    }
}

/// Whether the line of sight from `a` to `b`, which lie on different sides of the line of `occluder`, passes
/// between the ends of the occluder by more than a margin.
fn crosses(a: &Point2<f64>, b: &Point2<f64>, occluder: &Edge) -> bool {
    let along = b - a;
    let least = MARGIN_M * along.norm();
    let (from, to) = (along.perp(&(occluder.from - a)), along.perp(&(occluder.to - a)));
    from > least && to < -least || from < -least && to > least
}

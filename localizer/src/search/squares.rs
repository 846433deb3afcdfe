//! The squares of positions that a search divides, and the bounds of their scores.

use super::{Node, Search, Window};
use crate::constants::{FAR_M, SEARCH_CHUNK, TOP};
use crate::score_grid::ScoreGrid;
use crate::work;
use interfaces::{Cell, GridFrame, Spread, heading_rad, wrap_rad};
use nalgebra::{Point2, Vector2};
use std::f64::consts::PI;

/// The same of poses in a search, and of places of submaps.
const SAME_PLACE: Spread = Spread { m: 0.4, rad: 0.35 };

/// The points of a scan at one heading, in cells from the robot, with their weights.
type Turned = Vec<(i32, i32, u32)>;

/// The squares of one search.
pub(super) struct Squares<'a> {
    grid: &'a ScoreGrid,
    headings_rad: Vec<f64>,
    turned: Vec<Turned>,
    perfect: u32,
    /// The lower left and the upper right cell of the positions.
    cells: (Cell, Cell),
    /// The level of the largest squares, and the number of their columns and rows.
    pub(super) level: usize,
    columns: usize,
    rows: usize,
}

impl<'a> Squares<'a> {
    pub(super) fn new(search: &Search, grid: &'a ScoreGrid) -> Self {
        let cell_m = grid.frame.resolution_m();
        let window = &search.window;
        let headings_rad = headings(window, grid);
        let turned = headings_rad.iter().map(|heading| turned(&search.points, *heading, cell_m)).collect();
        let (low, high) = cells(&grid.frame, window);
        // A window is small: large squares would not fit in it.
        let level = if window.reach_rad < PI { TOP - 2 } else { TOP };
        let count = |low: i32, high: i32| ((high + 1 - low).max(0) as usize).div_ceil(1 << level);
        let (columns, rows) = (count(low.x, high.x), count(low.y, high.y));
        let (perfect, cells) = (search.perfect(), (low, high));
        Self { grid, headings_rad, turned, perfect, cells, level, columns, rows }
    }

    /// The number of the largest squares.
    pub(super) fn len(&self) -> usize {
        if self.turned[0].is_empty() { 0 } else { self.headings_rad.len() * self.columns * self.rows }
    }

    /// The heading and the lower left cell of one of the largest squares.
    pub(super) fn at(&self, number: usize) -> (usize, (i32, i32)) {
        let (place, heading) = (number / self.headings_rad.len(), number % self.headings_rad.len());
        let (column, row) = ((place % self.columns) as i32, (place / self.columns) as i32);
        (heading, (self.cells.0.x + (column << self.level), self.cells.0.y + (row << self.level)))
    }

    /// The square of positions from its lower left cell, if the robot can be in it and the bound of its score reaches
    /// `min_bound`.
    pub(super) fn node(
        &self,
        level: usize,
        heading: usize,
        (x, y): (i32, i32),
        min_bound: u32,
        left: &mut usize,
    ) -> Option<Node> {
        let (low, high) = self.cells;
        let side = 1 << level;
        let is_inside = x <= high.x && y <= high.y && x + side > low.x && y + side > low.y;
        let is_possible = is_inside && self.grid.has_free(level, x, y);
        let (points, bounds) = (&self.turned[heading], &self.grid.scores[level]);
        let (mut bound, mut max_bound, mut seen) = (0, self.perfect, 0);
        for some in points.chunks(SEARCH_CHUNK).take_while(|_| is_possible) {
            if max_bound < min_bound {
                break;
            }
            for &(dx, dy, weight) in some {
                let score = bounds.bound(x + dx, y + dy);
                bound += weight * u32::from(score);
                max_bound -= weight * u32::from(u8::MAX - score);
            }
            seen += some.len();
        }
        work::count(seen + 1);
        *left = left.saturating_sub(seen + 1);
        (is_possible && max_bound >= min_bound).then_some(Node { bound, level, heading, x, y })
    }

    /// Whether all poses of a square are close to a better pose.
    pub(super) fn is_same(&self, best: &Node, node: &Node) -> bool {
        let turn = wrap_rad(self.headings_rad[node.heading] - self.headings_rad[best.heading]);
        let (frame, last) = (&self.grid.frame, (1 << node.level) - 1);
        let at = frame.center(Cell::new(best.x, best.y));
        let corner = |x: i32, y: i32| (frame.center(Cell::new(x, y)) - at).norm() <= SAME_PLACE.m;
        turn.abs() <= SAME_PLACE.rad
            && corner(node.x, node.y)
            && corner(node.x + last, node.y)
            && corner(node.x, node.y + last)
            && corner(node.x + last, node.y + last)
    }
}

/// The lower left and the upper right cell of a window.
pub(super) fn cells(frame: &GridFrame, window: &Window) -> (Cell, Cell) {
    let last = Cell::new(frame.width() as i32 - 1, frame.height() as i32 - 1);
    let middle = Point2::from(window.pose.translation.vector);
    let reach = Vector2::new(window.reach_m, window.reach_m);
    let (low, high) = (frame.cell_at(&(middle - reach)), frame.cell_at(&(middle + reach)));
    (Cell::new(low.x.max(0), low.y.max(0)), Cell::new(high.x.min(last.x), high.y.min(last.y)))
}

/// The headings to search, rad: at each, the farthest points move by two cells.
pub(super) fn headings(window: &Window, grid: &ScoreGrid) -> Vec<f64> {
    let step_rad = 2.0 * grid.frame.resolution_m() / FAR_M;
    let (middle_rad, reach_rad) = (heading_rad(&window.pose), window.reach_rad.min(PI));
    let steps = libm::ceil(reach_rad / step_rad) as i32;
    let last = if reach_rad < PI { steps } else { steps - 1 };
    (-steps..=last).map(|step| middle_rad + f64::from(step) * reach_rad / f64::from(steps.max(1))).collect()
}

fn turned(points: &[(Point2<f64>, u32)], heading_rad: f64, cell_m: f64) -> Turned {
    let rotation = interfaces::rotation(heading_rad);
    let cell = |x: f64| libm::floor(x / cell_m + 0.5) as i32;
    let turn = |(at, weight): &(Point2<f64>, u32)| {
        let arm = rotation * at.coords;
        (cell(arm.x), cell(arm.y), *weight)
    };
    points.iter().map(turn).collect()
}

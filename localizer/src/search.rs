//! The search for a pose: branch and bound over x, y and heading, in a window (Olson 2009) or in the whole map (Hess et
//! al. 2016).

#[cfg(test)]
mod tests;

use crate::constants::{FAR_M, MAX_CANDIDATES, MAX_NODES, SAME_PLACE, SEARCH_CHUNK, SEARCH_POINTS, TOP};
use crate::scan_points::ScanPoint;
use crate::score_grid::ScoreGrid;
use crate::work;
use interfaces::{Cell, GridFrame, heading_rad, wrap_rad};
use nalgebra::{Isometry2, Point2, Vector2};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::PI;

/// Where to search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    /// The middle of the window.
    pub(crate) pose: Isometry2<f64>,
    /// The largest distance from the middle in x and in y, m.
    pub(crate) reach_m: f64,
    /// The largest turn, rad.
    pub(crate) reach_rad: f64,
}

/// A pose that fits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub(crate) pose: Isometry2<f64>,
    /// The score, from 0 to 1.
    #[cfg(test)]
    pub(crate) score: f64,
}

/// A square of positions at one heading. Ordered by the bound of its score, then by a fixed order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Node {
    bound: u32,
    level: usize,
    heading: usize,
    x: i32,
    y: i32,
}

impl Ord for Node {
    fn cmp(&self, other: &Self) -> Ordering {
        // Of equal bounds, the smaller square first: it is nearer to a result.
        let place = |node: &Self| (node.heading, node.y, node.x);
        let by_score = self.bound.cmp(&other.bound).then_with(|| other.level.cmp(&self.level));
        by_score.then_with(|| place(other).cmp(&place(self)))
    }
}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The points of a scan at one heading, in cells from the robot, with their weights.
type Turned = Vec<(i32, i32, u32)>;

/// One search.
struct Search<'a> {
    grid: &'a ScoreGrid,
    headings_rad: Vec<f64>,
    turned: Vec<Turned>,
    /// The score of a perfect fit.
    perfect: u32,
    /// The lower left and the upper right cell of the positions.
    cells: (Cell, Cell),
}

/// The poses that fit best, the best first: all that differ and reach `ratio` of the best score, up to a number.
/// Without a window, the whole map is searched.
pub(crate) fn search(
    grid: &ScoreGrid,
    points: &[ScanPoint],
    window: Option<&Window>,
    least_score: f64,
    ratio: f64,
) -> Vec<Candidate> {
    let chosen = spread(points);
    if chosen.is_empty() {
        return Vec::new();
    }
    let cell_m = grid.frame().resolution_m();
    let headings_rad = headings(window, cell_m);
    let turn = |heading: &f64| turned(&chosen, *heading, cell_m);
    let search = Search {
        grid,
        turned: headings_rad.iter().map(turn).collect(),
        headings_rad,
        perfect: 255 * chosen.iter().map(|(_, weight)| weight).sum::<u32>(),
        cells: cells(grid.frame(), window),
    };
    // A window is small: large squares would not fit in it.
    let is_small = window.is_some_and(|window| window.reach_rad < PI);
    let level = if is_small { TOP - 2 } else { TOP };
    search.best_first(level, least_score, ratio)
}

/// The lower left and the upper right cell of a window, or of the whole map.
fn cells(frame: &GridFrame, window: Option<&Window>) -> (Cell, Cell) {
    let last = Cell::new(frame.width() as i32 - 1, frame.height() as i32 - 1);
    let Some(window) = window else { return (Cell::new(0, 0), last) };
    let middle = Point2::from(window.pose.translation.vector);
    let reach = Vector2::new(window.reach_m, window.reach_m);
    let (low, high) = (frame.cell_at(&(middle - reach)), frame.cell_at(&(middle + reach)));
    (Cell::new(low.x.max(0), low.y.max(0)), Cell::new(high.x.min(last.x), high.y.min(last.y)))
}

/// At most [`SEARCH_POINTS`] points, evenly along the surfaces, each with a whole weight.
fn spread(points: &[ScanPoint]) -> Vec<(Point2<f64>, u32)> {
    let total: f64 = points.iter().map(|point| point.weight).sum();
    let step = (total / SEARCH_POINTS as f64).max(1e-9);
    let (mut passed, mut chosen) = (0.0, Vec::with_capacity(SEARCH_POINTS));
    for point in points {
        let before = libm::floor(passed / step);
        passed += point.weight;
        let count = libm::floor(passed / step) - before;
        if count >= 1.0 {
            chosen.push((point.at, count as u32));
        }
    }
    // Far points tell poses apart soonest.
    let square = |point: &(Point2<f64>, u32)| point.0.coords.norm_squared();
    chosen.sort_by(|a, b| square(b).total_cmp(&square(a)));
    chosen
}

fn headings(window: Option<&Window>, cell_m: f64) -> Vec<f64> {
    let step_rad = 2.0 * cell_m / FAR_M;
    let (middle_rad, reach_rad) =
        window.map_or((0.0, PI), |window| (heading_rad(&window.pose), window.reach_rad.min(PI)));
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

impl Search<'_> {
    /// The upper bound of the scores of a square of positions; at level 0, the score. `None` if it is below `least`.
    fn bound(&self, level: usize, heading: usize, x: i32, y: i32, least: u32) -> Option<u32> {
        let (mut sum, mut left) = (0, self.perfect);
        for some in self.turned[heading].chunks(SEARCH_CHUNK) {
            for &(dx, dy, weight) in some {
                sum += weight * u32::from(self.grid.bound(level, x + dx, y + dy));
                left -= 255 * weight;
            }
            if sum + left < least {
                return None;
            }
        }
        Some(sum)
    }

    /// A square of positions, if the robot can be in it and the bound of its score reaches `least`.
    fn node(&self, level: usize, heading: usize, x: i32, y: i32, least: u32) -> Option<Node> {
        let (low, high) = self.cells;
        let side = 1 << level;
        let is_inside = x <= high.x && y <= high.y && x + side > low.x && y + side > low.y;
        if !is_inside || !self.grid.has_free(x, y, side) {
            return None;
        }
        work::count(1);
        let bound = self.bound(level, heading, x, y, least)?;
        Some(Node { bound, level, heading, x, y })
    }

    /// The squares that cover the window.
    fn roots(&self, level: usize, least: u32) -> BinaryHeap<Node> {
        let (low, high) = self.cells;
        let side = 1_usize << level;
        let mut roots = BinaryHeap::new();
        for heading in 0..self.headings_rad.len() {
            for y in (low.y..=high.y).step_by(side) {
                for x in (low.x..=high.x).step_by(side) {
                    roots.extend(self.node(level, heading, x, y, least));
                }
            }
        }
        roots
    }

    fn best_first(&self, level: usize, least_score: f64, ratio: f64) -> Vec<Candidate> {
        let mut found: Vec<(Node, Point2<f64>)> = Vec::new();
        let mut least = (least_score * f64::from(self.perfect)) as u32;
        let mut nodes = self.roots(level, least);
        for _ in 0..MAX_NODES {
            let Some(node) = nodes.pop().filter(|node| node.bound >= least.max(1)) else { break };
            if found.len() == MAX_CANDIDATES {
                break;
            }
            if found.iter().any(|best| self.is_same(best, &node)) {
                continue;
            }
            if node.level == 0 {
                found.push((node, self.grid.frame().center(Cell::new(node.x, node.y))));
                least = least.max((ratio * f64::from(found[0].0.bound)) as u32);
                continue;
            }
            let half = 1 << (node.level - 1);
            for (dx, dy) in [(0, 0), (half, 0), (0, half), (half, half)] {
                nodes.extend(self.node(node.level - 1, node.heading, node.x + dx, node.y + dy, least));
            }
        }
        let candidate = |(node, at): &(Node, Point2<f64>)| Candidate {
            pose: interfaces::pose(at.x, at.y, self.headings_rad[node.heading]),
            #[cfg(test)]
            score: f64::from(node.bound) / f64::from(self.perfect),
        };
        found.iter().map(candidate).collect()
    }

    /// Whether all poses of a square are close to a better pose.
    fn is_same(&self, (best, at): &(Node, Point2<f64>), node: &Node) -> bool {
        let turn = wrap_rad(self.headings_rad[node.heading] - self.headings_rad[best.heading]);
        let last = (1 << node.level) - 1;
        let corner = |x: i32, y: i32| (self.grid.frame().center(Cell::new(x, y)) - at).norm() <= SAME_PLACE.m;
        turn.abs() <= SAME_PLACE.rad
            && corner(node.x, node.y)
            && corner(node.x + last, node.y)
            && corner(node.x, node.y + last)
            && corner(node.x + last, node.y + last)
    }
}

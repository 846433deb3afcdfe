//! The search for a pose: branch and bound over x, y and heading, in a window (Olson 2009) or in the whole map (Hess et
//! al. 2016), depth first, so that little must be kept of a search that goes on in the next scan.

mod squares;
#[cfg(test)]
mod tests;

use crate::constants::{MAX_CANDIDATES, SEARCH_POINTS};
use crate::scan_points::ScanPoint;
use crate::score_grid::ScoreGrid;
use interfaces::{Cell, GridFrame};
use nalgebra::{Isometry2, Point2, Vector2};
use squares::{Squares, headings};
use std::f64::consts::PI;

/// Where to search.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
pub(crate) struct Window {
    /// The middle of the window.
    pub(crate) pose: Isometry2<f64>,
    /// The largest distance from the middle in x and in y, m.
    pub(crate) reach_m: f64,
    /// The largest turn, rad.
    pub(crate) reach_rad: f64,
}

impl Window {
    /// All poses in a frame.
    pub(crate) fn of(frame: &GridFrame) -> Self {
        let sides_m = Vector2::new(frame.width() as f64, frame.height() as f64) * frame.resolution_m();
        let middle = frame.origin() + sides_m / 2.0;
        let pose = interfaces::pose(middle.x, middle.y, 0.0);
        Self { pose, reach_m: sides_m.max(), reach_rad: PI }
    }
}

/// A square of positions at one heading. At level 0, the bound is the score.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
struct Node {
    bound: u32,
    level: usize,
    heading: usize,
    x: i32,
    y: i32,
}

/// One search: the poses of a scan in a window.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(crate) struct Search {
    /// The points of the scan with their weights.
    points: Vec<(Point2<f64>, u32)>,
    window: Window,
    /// The smallest score, and the smallest share of the best one.
    min_score: f64,
    ratio: f64,
    /// The number of the next of the squares that cover the window, and the squares in the last one that are left.
    next: usize,
    nodes: Vec<Node>,
    /// The best poses so far that differ, the best first.
    found: Vec<Node>,
}

/// The poses in a window that fit best, the best first: all that differ and reach `ratio` of the best score, up to a number,
/// searched for in passes down to a score.
/// `left` is what is left of the work of a scan.
pub(crate) fn search(
    left: &mut usize,
    grid: &ScoreGrid,
    points: &[ScanPoint],
    window: &Window,
    (min_score, ratio): (f64, f64),
) -> Vec<Isometry2<f64>> {
    let mut search = Search::new(points, *window, lower(1.0, min_score), ratio);
    while search.pass(grid, left) && !search.is_over(min_score) {
        (search.next, search.min_score) = (0, lower(search.min_score, min_score));
    }
    search.candidates(grid)
}

/// The smallest score of the next pass: few squares can reach a high one, and most scans fit well somewhere.
pub(crate) fn lower(score: f64, min_score: f64) -> f64 {
    (0.8 * score).max(min_score)
}

impl Search {
    pub(crate) fn new(points: &[ScanPoint], window: Window, min_score: f64, ratio: f64) -> Self {
        let (points, nodes, found) = (spread(points), Vec::new(), Vec::new());
        Self { points, window, min_score, ratio, next: 0, nodes, found }
    }

    /// Whether no pass with a smaller score would find more.
    fn is_over(&self, min_score: f64) -> bool {
        self.min_score <= min_score || self.best_score() * self.ratio >= self.min_score
    }

    /// The score of a perfect fit.
    fn perfect(&self) -> u32 {
        (u32::from(u8::MAX) * self.points.iter().map(|(_, weight)| weight).sum::<u32>()).max(1)
    }

    /// The best score so far.
    pub(crate) fn best_score(&self) -> f64 {
        self.found.first().map_or(0.0, |best| f64::from(best.bound) / f64::from(self.perfect()))
    }

    /// The poses so far.
    pub(crate) fn candidates(&self, grid: &ScoreGrid) -> Vec<Isometry2<f64>> {
        let headings_rad = headings(&self.window, grid);
        let pose = |node: &Node| {
            let at = grid.frame.center(Cell::new(node.x, node.y));
            interfaces::pose(at.x, at.y, headings_rad[node.heading])
        };
        self.found.iter().map(pose).collect()
    }

    /// Goes on until all squares with a score are searched, or nothing is `left` of the work; returns whether all are.
    pub(crate) fn pass(&mut self, grid: &ScoreGrid, left: &mut usize) -> bool {
        let squares = Squares::new(self, grid);
        while *left > 0 {
            match self.nodes.pop() {
                Some(node) => self.split(&squares, &node, left),
                None if self.next < squares.len() => {
                    let (heading, corner) = squares.at(self.next);
                    self.next += 1;
                    self.nodes.extend(squares.node(squares.level, heading, corner, self.min_bound(), left));
                }
                None => return true,
            }
        }
        false
    }

    /// The smallest score of a pose that would be kept.
    fn min_bound(&self) -> u32 {
        let min_bound = (self.min_score * f64::from(self.perfect())) as u32;
        let best = self.found.first().map_or(0, |best| (self.ratio * f64::from(best.bound)) as u32);
        let worst = self.found.get(MAX_CANDIDATES - 1).map_or(0, |worst| worst.bound + 1);
        min_bound.max(best).max(worst).max(1)
    }

    /// Divides a square in four, of which the best is next; or keeps a pose.
    fn split(&mut self, squares: &Squares, node: &Node, left: &mut usize) {
        let min_bound = self.min_bound();
        let is_better = |best: &Node| best.bound >= node.bound && squares.is_same(best, node);
        if node.bound < min_bound || self.found.iter().any(is_better) {
            return;
        }
        let Some(level) = node.level.checked_sub(1) else { return self.keep(squares, node) };
        let (half, first) = (1 << level, self.nodes.len());
        for (dx, dy) in [(0, 0), (half, 0), (0, half), (half, half)] {
            let corner = (node.x + dx, node.y + dy);
            self.nodes.extend(squares.node(level, node.heading, corner, min_bound, left));
        }
        self.nodes[first..].sort_by_key(|node| node.bound);
    }

    fn keep(&mut self, squares: &Squares, node: &Node) {
        self.found.retain(|worse| worse.bound >= node.bound || !squares.is_same(node, worse));
        let rank = self.found.partition_point(|better| better.bound >= node.bound);
        self.found.insert(rank, *node);
        self.found.truncate(MAX_CANDIDATES);
        let min_bound = (self.ratio * f64::from(self.found[0].bound)) as u32;
        self.found.retain(|node| node.bound >= min_bound);
    }
}

/// At most [`SEARCH_POINTS`] points, evenly along the surfaces, each with a whole weight.
fn spread(points: &[ScanPoint]) -> Vec<(Point2<f64>, u32)> {
    let total: f64 = points.iter().map(|point| point.weight).sum();
    let step = (total / SEARCH_POINTS as f64).max(f64::MIN_POSITIVE);
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

//! The search for the pose in the whole map. Of a map that is too large for one scan, one part is searched per scan.

use super::{MapMatcher, Step};
use crate::changing_map::ChangingMap;
use crate::constants::{AMBIGUOUS, MAX_EMPTY_PARTS, MAX_REACH_M, MAX_SIDE_M, MIN_FOUND, MIN_SCORE};
use crate::hypotheses::Hypotheses;
use crate::scan_points::ScanPoint;
use crate::score_grid::ScoreGrid;
use crate::search::{Candidate, Window, search};
use crate::surfel_map::SurfelMap;
use interfaces::GridFrame;
use nalgebra::{Point2, Vector2};
use std::f64::consts::PI;

/// A search that goes on in the next scan.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(in crate::localizer) struct WideSearch {
    /// How far the points are from the robot at most, m, and the number of the next part.
    reach_m: f64,
    next: usize,
    /// What the parts so far contain. It follows the robot until the last part is searched.
    pub(in crate::localizer) found: Hypotheses,
}

impl WideSearch {
    fn new(points: &[ScanPoint]) -> Self {
        Self { reach_m: reach_m(points), next: 0, found: Hypotheses::default() }
    }

    /// The next part with a surface; `None` after the last one.
    fn next_with_surfaces(&mut self, surfels: &SurfelMap) -> Option<Window> {
        for _ in 0..MAX_EMPTY_PARTS {
            let part = self.next(surfels.frame())?;
            let (middle, reach_m) = (part.pose.translation.vector, part.reach_m + self.reach_m);
            if surfels.usable().any(|surfel| (surfel.at.coords - middle).amax() <= reach_m) {
                return Some(part);
            }
        }
        self.next(surfels.frame())
    }

    /// The next part of a map; `None` after the last one.
    fn next(&mut self, frame: &GridFrame) -> Option<Window> {
        let side_m = MAX_SIDE_M - 2.0 * self.reach_m;
        let parts = |cells: usize| (cells as f64 * frame.resolution_m() / side_m).ceil() as usize;
        let (columns, rows) = (parts(frame.width()), parts(frame.height()));
        let (column, row) = (self.next % columns, self.next / columns);
        self.next += 1;
        let middle = frame.origin() + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) * side_m;
        let pose = interfaces::pose(middle.x, middle.y, 0.0);
        (row < rows).then_some(Window { pose, reach_m: side_m / 2.0, reach_rad: PI })
    }
}

/// How far the points of a scan are from the robot, at most as far as is looked for, m.
fn reach_m(points: &[ScanPoint]) -> f64 {
    let farthest_m = points.iter().map(|point| point.at.coords.norm()).fold(0.0, f64::max);
    farthest_m.min(MAX_REACH_M)
}

impl MapMatcher {
    /// The poses at which the scan fits: in a window, or in the whole map, which must not be large then.
    pub(in crate::localizer) fn candidates<M: ChangingMap>(
        &mut self,
        step: &Step<M>,
        window: Option<&Window>,
    ) -> Vec<Candidate> {
        let (points, states) = (&step.scan.points, step.map.states());
        match window {
            Some(window) if self.is_large() => {
                let reach_m = reach_m(points).min(MAX_SIDE_M / 2.0 - window.reach_m);
                let near = |point: &&ScanPoint| point.at.coords.norm() <= reach_m;
                let near: Vec<ScanPoint> = points.iter().filter(near).copied().collect();
                let middle = Point2::from(window.pose.translation.vector);
                let grid = ScoreGrid::around(&self.surfels, states, &middle, reach_m + window.reach_m);
                search(&grid, &near, Some(window), MIN_FOUND, AMBIGUOUS)
            }
            _ => {
                // The scores are made again when the line map has changed.
                let grid = match self.relocalization.scores.take() {
                    Some((known, grid)) if known == self.surfels.revision() => grid,
                    _ => ScoreGrid::new(&self.surfels, states),
                };
                let found = search(&grid, points, window, MIN_FOUND, AMBIGUOUS);
                self.relocalization.scores = Some((self.surfels.revision(), grid));
                found
            }
        }
    }

    /// Whether the scores of the whole map are too many for one scan.
    fn is_large(&self) -> bool {
        let frame = self.surfels.frame();
        let cells_m2 = frame.len() as f64 * frame.resolution_m() * frame.resolution_m();
        cells_m2 > MAX_SIDE_M * MAX_SIDE_M
    }

    /// The poses in the whole map. `None` if the search goes on in the next scan.
    pub(in crate::localizer) fn search_everywhere<M: ChangingMap>(
        &mut self,
        step: &Step<M>,
    ) -> Option<Hypotheses> {
        if !self.is_large() {
            let candidates = self.candidates(step, None);
            return Some(Hypotheses::start(&self.scene(step), &candidates, MIN_SCORE));
        }
        let wide = self.relocalization.wide.take();
        let is_first = wide.is_none();
        let mut wide = wide.unwrap_or_else(|| WideSearch::new(&step.scan.points));
        if !is_first {
            wide.found.advance(&self.scene(step), &step.scan.motion, MIN_SCORE);
        }
        let part = wide.next_with_surfaces(&self.surfels);
        let candidates = part.map_or(Vec::new(), |window| self.candidates(step, Some(&window)));
        let new = Hypotheses::start(&self.scene(step), &candidates, MIN_SCORE);
        wide.found = wide.found.restarted().or(new);
        if part.is_none() {
            return Some(wide.found);
        }
        self.relocalization.wide = Some(wide);
        None
    }
}

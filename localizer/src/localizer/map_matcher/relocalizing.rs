//! The search for a pose that tracking has lost, in the whole map part by part, and the choice between several poses. The work per
//! scan is bounded; the rest is done in the next scans.

use super::{MapMatcher, Step};
use crate::constants::{
    AMBIGUOUS, CARRIED, CELLS_PER_LOOKUP, CONFIRM_SCANS, MAJORITY, MAX_SIDE_M, MAX_WORK, MIN_CONFIRMED,
    MIN_FOUND, MIN_SCORE, MIN_SUPPORT, MINOR, SEARCH_EVERY,
};
use crate::hypotheses::Hypotheses;
use crate::localizer::state::{Event, State};
use crate::motion::Motion;
use crate::placement::Placement;
use crate::scan_points::ScanPoint;
use crate::score_grid::ScoreGrid;
use crate::search::{Search, Window, lower, search};
use crate::support::Support;
use crate::tracking::Tracked;
use crate::verification::Verification;
use interfaces::GridFrame;
use nalgebra::{Isometry2, Point2, Vector2};
use std::f64::consts::PI;

/// Surfaces farther away are not looked for in parts of a map, m.
const MAX_REACH_M: f64 = 28.8;

/// A search that goes on in the next scan.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(in crate::localizer) struct WideSearch {
    /// How far the points are from the robot at most, m.
    reach_m: f64,
    /// The score down to which this pass searches, and the best one that it has found.
    min_score: f64,
    best_score: f64,
    /// The number of the next part.
    next: usize,
    /// The search in the present part, with the scan at its begin, and the motion since that scan.
    part: Option<(Search, Isometry2<f64>)>,
    /// The scores of the part with a number.
    scores: Option<(usize, ScoreGrid)>,
    /// What the parts so far contain. It follows the robot until the last part is searched.
    found: Hypotheses,
}

impl WideSearch {
    fn new(points: &[ScanPoint]) -> Self {
        let (reach_m, min_score) = (reach_m(points), lower(1.0, MIN_FOUND));
        let found = Hypotheses::default();
        Self { reach_m, min_score, best_score: 0.0, next: 0, part: None, scores: None, found }
    }

    /// Moves what was found, and the robot from where the present part was begun.
    pub(super) fn follow_odometry(&mut self, motion: &Motion) {
        self.found.follow_odometry(motion);
        if let Some((_, since)) = &mut self.part {
            *since = motion.apply(since);
        }
    }

    /// A part of a map; `None` after the last one.
    fn window(&self, number: usize, frame: &GridFrame) -> Option<Window> {
        let side_m = MAX_SIDE_M - 2.0 * self.reach_m;
        let parts = |cells: usize| (cells as f64 * frame.resolution_m() / side_m).ceil() as usize;
        let (columns, rows) = (parts(frame.width()), parts(frame.height()));
        let (column, row) = (number % columns, number / columns);
        let middle = frame.origin() + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) * side_m;
        let pose = interfaces::pose(middle.x, middle.y, 0.0);
        (row < rows).then_some(Window { pose, reach_m: side_m / 2.0, reach_rad: PI })
    }

    /// Whether a pass has found all poses that are nearly as good as the best one.
    fn is_over(&self) -> bool {
        let is_found = !self.found.is_empty() && self.best_score * AMBIGUOUS >= self.min_score;
        is_found || self.min_score <= MIN_FOUND
    }
}

/// How far the points of a scan are from the robot, at most as far as is looked for, m.
fn reach_m(points: &[ScanPoint]) -> f64 {
    let farthest_m = points.iter().map(|point| point.at.coords.norm()).fold(0.0, f64::max);
    farthest_m.min(MAX_REACH_M)
}

fn near(points: &[ScanPoint], reach_m: f64) -> Vec<ScanPoint> {
    points.iter().filter(|point| point.at.coords.norm() <= reach_m).copied().collect()
}

/// The search for a pose.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(in crate::localizer) struct Relocalization {
    pub(in crate::localizer) hypotheses: Hypotheses,
    /// The search in the whole map, while it goes on.
    pub(in crate::localizer) wide: Option<WideSearch>,
    /// The number of scans since the last search in the whole map.
    pub(in crate::localizer) scans: u32,
}

impl Default for Relocalization {
    fn default() -> Self {
        Self { hypotheses: Hypotheses::default(), wide: None, scans: u32::MAX }
    }
}

impl MapMatcher {
    /// The poses in a window at which the scan fits.
    pub(in crate::localizer) fn candidates(
        &self,
        step: &Step,
        window: &Window,
        left: &mut usize,
    ) -> Vec<Isometry2<f64>> {
        let reach_m = reach_m(&step.scan.points);
        let grid = self.scores(step, window, reach_m);
        *left = left.saturating_sub(grid.cells() / CELLS_PER_LOOKUP);
        let points = near(&step.scan.points, reach_m);
        search(left, &grid, &points, window, (MIN_FOUND, AMBIGUOUS))
    }

    /// The scores of what can be seen from a window.
    fn scores(&self, step: &Step, window: &Window, reach_m: f64) -> ScoreGrid {
        let middle = Point2::from(window.pose.translation.vector);
        ScoreGrid::around(&self.surfels, step.states, &middle, reach_m + window.reach_m)
    }

    /// The poses in the whole map. `None` if the search goes on in the next scan.
    fn search_everywhere(&mut self, step: &Step, mut left: usize) -> Option<Hypotheses> {
        let wide = self.relocalization.wide.take();
        let mut wide = wide.unwrap_or_else(|| WideSearch::new(&step.scan.points));
        wide.found.compare(&self.scene(step), MIN_SCORE);
        while left > 0 {
            if self.search_part(step, &mut wide, &mut left) {
                continue;
            }
            if wide.is_over() {
                return Some(wide.found.restarted());
            }
            (wide.next, wide.min_score) = (0, lower(wide.min_score, MIN_FOUND));
        }
        self.relocalization.wide = Some(wide);
        None
    }

    /// Searches in the present part, or in the next one. Returns false after the last one.
    fn search_part(&self, step: &Step, wide: &mut WideSearch, left: &mut usize) -> bool {
        let Some(window) = wide.window(wide.next, &self.surfels.frame) else { return false };
        if wide.scores.as_ref().is_none_or(|(number, _)| *number != wide.next) {
            if *left < MAX_WORK / 2 {
                *left = 0; // the tables of a large part are made in the next scan
                return true;
            }
            let scores = self.scores(step, &window, wide.reach_m);
            *left = left.saturating_sub(scores.cells() / CELLS_PER_LOOKUP);
            wide.scores = Some((wide.next, scores));
        }
        let Some((_, scores)) = &wide.scores else { return false };
        let begin = || {
            let points = near(&step.scan.points, wide.reach_m);
            let min_score = if wide.found.is_empty() { 0.0 } else { AMBIGUOUS * wide.best_score };
            (Search::new(&points, window, wide.min_score.max(min_score), AMBIGUOUS), Isometry2::identity())
        };
        let (begun, since) = wide.part.get_or_insert_with(begin);
        if begun.pass(scores, left) {
            let mut candidates = begun.candidates(scores);
            candidates.iter_mut().for_each(|pose| *pose *= *since);
            let found = Hypotheses::start(&self.scene(step), &candidates, MIN_SCORE);
            wide.best_score = wide.best_score.max(begun.best_score());
            wide.found = std::mem::take(&mut wide.found).restarted().or(found);
            wide.part = None;
            wide.next += 1;
        }
        true
    }

    /// Searches around a pose that the scan contradicts, though a pose prior allows it: a robot that was carried along a
    /// corridor still sees most of its walls. If another pose is clearly better, the prior was wrong.
    pub(in crate::localizer) fn doubt_prior(&mut self, step: &mut Step, tracked: &Tracked) {
        let share = tracked.support.share();
        if share >= MIN_SUPPORT || !self.is_due() {
            return;
        }
        self.relocalization.scans = 0;
        let found = self.search_around(step, MIN_SUPPORT, &mut { MAX_WORK });
        if found.best().is_some_and(|best| best.support.share() >= share + MINOR) {
            self.ignores_prior = true;
            self.take(step, found);
        }
    }

    /// Counts a scan, and returns whether a search is due.
    fn is_due(&mut self) -> bool {
        self.relocalization.scans = self.relocalization.scans.saturating_add(1);
        self.relocalization.scans >= SEARCH_EVERY
    }

    /// The poses in a window around the last one.
    fn search_around(&self, step: &Step, min_score: f64, left: &mut usize) -> Hypotheses {
        let window = Window { pose: step.track.pose, reach_m: CARRIED.m, reach_rad: CARRIED.rad };
        let candidates = self.candidates(step, &window, left);
        Hypotheses::start(&self.scene(step), &candidates, min_score)
    }

    /// Searches for the pose: around the predicted pose, and in the whole map.
    pub(in crate::localizer) fn search(&mut self, step: &mut Step, tracked: &Tracked) {
        let is_due = self.is_due() || self.relocalization.wide.is_some();
        let is_near = self.state != State::Lost;
        let (mut found, mut left) = (Hypotheses::default(), MAX_WORK);
        if is_near {
            found = self.search_around(step, MAJORITY, &mut left);
        }
        let is_clear = found.best().is_some_and(|best| best.support.score() >= MIN_SUPPORT);
        // Where most of the scan fits, the map is not finished or the view has changed: far away, something in an
        // unfinished map always fits better.
        let is_elsewhere = !is_near || tracked.support.share() < MAJORITY;
        if !is_clear && is_elsewhere && is_due {
            self.relocalization.scans = 0;
            if let Some(anywhere) = self.search_everywhere(step, left) {
                found = found.or(anywhere);
            }
        }
        if !found.is_empty() {
            self.relocalization.wide = None;
        }
        let is_confirmed = is_near && found.contains(&tracked.placement.pose);
        if is_confirmed && tracked.support.confirmed >= MIN_CONFIRMED {
            // Much has changed here, but no other pose fits better.
            self.accepted_support = tracked.support.share() - MINOR;
            self.accept(step, tracked);
        } else {
            // What a search has found is verified before a pose prior is followed again.
            self.ignores_prior = !found.is_empty();
            self.take(step, found);
        }
    }

    /// Takes over what a search has found.
    fn take(&mut self, step: &mut Step, found: Hypotheses) {
        if !found.is_empty() {
            self.on(Event::Found);
        }
        self.relocalization.hypotheses = found;
        self.take_best(step);
    }

    /// Compares all hypotheses with the scan; the last one that is left becomes the pose.
    pub(in crate::localizer) fn follow(&mut self, step: &mut Step) -> Support {
        let mut hypotheses = std::mem::take(&mut self.relocalization.hypotheses);
        hypotheses.follow_odometry(&step.scan.motion);
        hypotheses.compare(&self.scene(step), MIN_SCORE);
        if self.times.certain_s > f64::NEG_INFINITY {
            hypotheses.prefer(CONFIRM_SCANS, |pose| self.is_where_odometry_says(pose));
        }
        self.is_due();
        let support = hypotheses.best().map_or(Support::default(), |best| best.support);
        if let Some(decided) = hypotheses.decided(CONFIRM_SCANS) {
            self.accepted_support = MIN_SUPPORT.min(support.share() - MINOR);
            self.on(Event::Decided);
            self.verification = Verification::after(CONFIRM_SCANS);
            let placement = Placement::rigid(&decided.pose);
            self.accept(step, &Tracked::new(placement, [decided.covariance; 2], support));
            return support;
        }
        self.relocalization.hypotheses = hypotheses;
        if self.relocalization.hypotheses.is_empty() {
            self.ignores_prior = false;
            let (motion, track) = (&step.scan.motion, &mut step.track);
            track.covariance = motion.propagate(&track.pose, &track.covariance);
            track.pose = motion.apply(&track.pose);
            self.on(Event::Exhausted);
        }
        self.take_best(step);
        self.doubt();
        support
    }

    /// Follows the odometry: the scan shows nothing, which says nothing against a pose either.
    pub(in crate::localizer) fn dead_reckon(&mut self, step: &mut Step) {
        self.relocalization.hypotheses.follow_odometry(&step.scan.motion);
        self.take_best(step);
        self.times.supported_s += if step.scan.fault.is_none() { step.scan.elapsed_s } else { 0.0 };
        self.on(Event::Unsupported);
    }

    /// Reports the best hypothesis, with the spread of all.
    fn take_best(&self, step: &mut Step) {
        let hypotheses = &self.relocalization.hypotheses;
        if let Some(best) = hypotheses.best() {
            (step.track.pose, step.track.covariance) = (best.pose, best.covariance + hypotheses.spread());
        }
    }
}

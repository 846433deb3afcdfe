//! The search for a pose that tracking has lost, and the choice between several poses.

use super::Localizer;
use super::estimating::{LEAST_CONFIRMED, LEAST_GUIDE};
use crate::changing_map::ChangingMap;
use crate::estimate::PoseState;
use crate::hypotheses::Hypotheses;
use crate::motion::Motion;
use crate::placement::Placement;
use crate::score_grid::ScoreGrid;
use crate::search::{Window, search};
use crate::support::Support;
use crate::tracking::Tracked;
use crate::verification::Verification;
use interfaces::LaserReading;

/// The window of the first search: a glitch of the odometry, or a robot that was carried a little.
const WINDOW_M: f64 = 1.3;
const WINDOW_RAD: f64 = 1.2;
/// The least score of a pose in a search.
const LEAST_FOUND: f64 = 0.55;
/// The least score of a refined pose: around the predicted pose, and anywhere.
const LEAST_SCORE_NEAR: f64 = 0.5;
const LEAST_SCORE: f64 = 0.65;
/// A pose near the predicted pose with this score makes a search in the whole map needless.
const CLEAR_SCORE: f64 = 0.85;
/// The number of scans between two searches in the whole map.
const SEARCH_EVERY: u32 = 5;

impl Localizer {
    /// Searches for the pose: around the predicted pose, and in the whole map.
    pub(super) fn search(
        &mut self,
        reading: &LaserReading,
        motion: &Motion,
        map: &impl ChangingMap,
        tracked: &Tracked,
    ) {
        self.since_search = self.since_search.saturating_add(1);
        let revision = self.surfels.revision();
        let grid = match self.scores.take() {
            Some((known, grid)) if known == revision => grid,
            _ => ScoreGrid::new(&self.surfels, map.states()),
        };
        let ratio = self.settings.ambiguity_ratio;
        let is_near = self.state != PoseState::Lost;
        let window = Window { pose: self.pose, reach_m: WINDOW_M, reach_rad: WINDOW_RAD };
        let mut found = Hypotheses::default();
        if is_near {
            let candidates = search(&grid, self.points.points(), Some(&window), LEAST_FOUND, ratio);
            found = Hypotheses::start(&self.scene(reading, map), &candidates, LEAST_SCORE_NEAR, ratio);
        }
        let is_clear = found.best().is_some_and(|best| best.support.score() >= CLEAR_SCORE);
        // Where most of the scan fits, the map is not finished or the view has changed: far away, something in an
        // unfinished map always fits better.
        let is_elsewhere = !is_near || tracked.support.share() < LEAST_GUIDE;
        if !is_clear && is_elsewhere && self.since_search >= SEARCH_EVERY {
            self.since_search = 0;
            let candidates = search(&grid, self.points.points(), None, LEAST_FOUND, ratio);
            let anywhere = Hypotheses::start(&self.scene(reading, map), &candidates, LEAST_SCORE, ratio);
            found = found.or(anywhere, ratio);
        }
        self.scores = Some((revision, grid));
        let is_confirmed = is_near && found.contains(&tracked.placement.pose);
        if is_confirmed && tracked.support.confirmed >= LEAST_CONFIRMED {
            // Much has changed here, but no other pose fits better.
            self.accepted_support = tracked.support.share() - 0.1;
            self.accept(tracked);
            self.verify(&tracked.support, motion, &reading.scan);
        } else {
            self.hypotheses = found;
            self.take_best();
        }
    }

    /// Compares all hypotheses with the scan; the last one that is left becomes the pose.
    pub(super) fn follow(
        &mut self,
        reading: &LaserReading,
        motion: &Motion,
        map: &impl ChangingMap,
    ) -> Support {
        let mut hypotheses = std::mem::take(&mut self.hypotheses);
        let ratio = self.settings.ambiguity_ratio;
        hypotheses.advance(&self.scene(reading, map), motion, LEAST_SCORE, ratio);
        self.hypotheses = hypotheses;
        self.since_search = self.since_search.saturating_add(1);
        let support = self.hypotheses.best().map_or(Support::default(), |best| best.support);
        match self.hypotheses.decided(self.settings.scans_to_confirm) {
            Some(decided) => {
                let placement = Placement::rigid(&decided.pose);
                let tracked = Tracked::new(placement, [decided.covariance; 2], decided.support);
                self.accepted_support = self.settings.min_support.min(support.share() - 0.1);
                self.hypotheses = Hypotheses::default();
                if self.is_unfinished() {
                    self.verification = Some(Verification::after(self.settings.scans_to_confirm));
                }
                self.accept(&tracked);
                self.verify(&support, motion, &reading.scan);
            }
            None if self.hypotheses.is_empty() => {
                self.pose = motion.apply(&self.pose);
                self.covariance = motion.propagate(&self.pose, &self.covariance);
                self.doubt();
            }
            None => {
                self.take_best();
                self.doubt();
            }
        }
        support
    }

    /// Reports the best hypothesis, with the spread of all.
    fn take_best(&mut self) {
        if let Some(best) = self.hypotheses.best() {
            self.pose = best.pose;
            self.covariance = best.covariance + self.hypotheses.spread();
        }
    }
}

//! The search for a pose that tracking has lost, and the choice between several poses.

use super::Localizer;
use super::estimating::{LEAST_CONFIRMED, LEAST_GUIDE};
use crate::changing_map::ChangingMap;
use crate::estimate::PoseState;
use crate::hypotheses::{Hypotheses, Hypothesis};
use crate::motion::Motion;
use crate::placement::Placement;
use crate::search::Window;
use crate::support::Support;
use crate::tracking::Tracked;
use crate::verification::Verification;
use interfaces::LaserReading;

/// The window of the first search: a glitch of the odometry, or a robot that was carried a little.
const WINDOW_M: f64 = 1.3;
const WINDOW_RAD: f64 = 1.2;
/// The least score of a pose in a search.
pub(super) const LEAST_FOUND: f64 = 0.55;
/// The least score of a refined pose: around the predicted pose, and anywhere.
const MIN_SCORE_NEAR: f64 = 0.5;
pub(super) const MIN_SCORE: f64 = 0.65;
/// A pose near the predicted pose with this score makes a search in the whole map needless.
const CLEAR_SCORE: f64 = 0.85;
/// By this much the support of another pose is clearly better than that of a pose which a guide allows.
const CLEARLY_BETTER: f64 = 0.1;
/// The number of scans between two searches in the whole map, or beside a guide.
const SEARCH_EVERY: u32 = 5;

impl Localizer {
    /// Searches around a pose that the scan contradicts, though a guide allows it: a robot that was carried along a corridor
    /// still sees most of its walls. If another pose is clearly better, the guide was wrong.
    pub(super) fn doubt_guide(&mut self, reading: &LaserReading, map: &impl ChangingMap, tracked: &Tracked) {
        self.since_search = self.since_search.saturating_add(1);
        if tracked.support.share() >= self.settings.min_support || self.since_search < SEARCH_EVERY {
            return;
        }
        self.since_search = 0;
        let found = self.search_around(reading, map, CLEAR_SCORE);
        let is_clear = |best: &Hypothesis| best.support.share() >= tracked.support.share() + CLEARLY_BETTER;
        if found.best().is_some_and(is_clear) {
            (self.hypotheses, self.ignores_guide) = (found, true);
            self.take_best();
        }
    }

    /// The poses in a window around the last one.
    fn search_around(
        &mut self,
        reading: &LaserReading,
        map: &impl ChangingMap,
        least_score: f64,
    ) -> Hypotheses {
        let ratio = self.settings.ambiguity_ratio;
        let window = Window { pose: self.pose, reach_m: WINDOW_M, reach_rad: WINDOW_RAD };
        let candidates = self.candidates(map, Some(&window));
        Hypotheses::start(&self.scene(reading, map), &candidates, least_score, ratio)
    }

    /// Searches for the pose: around the predicted pose, and in the whole map.
    pub(super) fn search(
        &mut self,
        reading: &LaserReading,
        motion: &Motion,
        map: &impl ChangingMap,
        tracked: &Tracked,
    ) {
        self.since_search = self.since_search.saturating_add(1);
        let ratio = self.settings.ambiguity_ratio;
        let is_near = self.state != PoseState::Lost;
        let mut found = Hypotheses::default();
        if is_near {
            found = self.search_around(reading, map, MIN_SCORE_NEAR);
        }
        let is_clear = found.best().is_some_and(|best| best.support.score() >= CLEAR_SCORE);
        // Where most of the scan fits, the map is not finished or the view has changed: far away, something in an
        // unfinished map always fits better.
        let is_elsewhere = !is_near || tracked.support.share() < LEAST_GUIDE;
        let is_due = self.wide.is_some() || self.since_search >= SEARCH_EVERY;
        if !is_clear && is_elsewhere && is_due {
            self.since_search = 0;
            if let Some(anywhere) = self.search_everywhere(reading, motion, map) {
                found = found.or(anywhere, ratio);
            }
        }
        if !found.is_empty() {
            self.wide = None;
        }
        let is_confirmed = is_near && found.contains(&tracked.placement.pose);
        if is_confirmed && tracked.support.confirmed >= LEAST_CONFIRMED {
            // Much has changed here, but no other pose fits better.
            self.accepted_support = tracked.support.share() - 0.1;
            self.accept(tracked);
            self.verify(&tracked.support, motion, &reading.scan);
        } else {
            // What a search has found is verified before a guide is followed again.
            self.ignores_guide = !found.is_empty();
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
        hypotheses.advance(&self.scene(reading, map), motion, MIN_SCORE, ratio);
        if self.certain_s > f64::NEG_INFINITY {
            hypotheses.prefer(self.settings.scans_to_confirm, |pose| self.is_where_odometry_says(pose));
        }
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
                self.ignores_guide = false;
                self.covariance = motion.propagate(&self.pose, &self.covariance);
                self.pose = motion.apply(&self.pose);
                self.doubt();
            }
            None => {
                self.take_best();
                self.doubt();
            }
        }
        support
    }

    /// Follows the odometry for the time of a scan that shows nothing, s: it says nothing against a pose either.
    pub(super) fn dead_reckon(&mut self, motion: &Motion, elapsed_s: f64) -> Support {
        let predicted = self.guided(motion.predict(&self.pose, &self.covariance, false));
        (self.pose, self.covariance) = (predicted.pose, predicted.covariance);
        self.hypotheses.follow_odometry(motion);
        if let Some(wide) = &mut self.wide {
            wide.found.follow_odometry(motion);
        }
        self.take_best();
        self.supported_s = self.supported_s.map(|supported_s| supported_s + elapsed_s);
        self.state = if self.state == PoseState::Lost { PoseState::Lost } else { PoseState::Uncertain };
        Support::default()
    }

    /// Reports the best hypothesis, with the spread of all.
    fn take_best(&mut self) {
        if let Some(best) = self.hypotheses.best() {
            self.pose = best.pose;
            self.covariance = best.covariance + self.hypotheses.spread();
        }
    }
}

//! The search for a pose that tracking has lost, and the choice between several poses.

use super::super::state::{Event, State};
use super::everywhere::WideSearch;
use super::{MapMatcher, Step};
use crate::constants::{
    CARRIED, CONFIRM_SCANS, MAJORITY, MAX_WORK, MIN_CONFIRMED, MIN_SCORE, MIN_SUPPORT, MINOR, SEARCH_EVERY,
};
use crate::hypotheses::Hypotheses;
use crate::placement::Placement;
use crate::search::Window;
use crate::support::Support;
use crate::tracking::Tracked;
use crate::verification::Verification;

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

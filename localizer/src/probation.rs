//! A pose that a search has found earns its certainty.
//!
//! In a map that is not finished, the true place may be missing, and something in the map always looks a little like it. A
//! found pose is certain once the scans agree with the map so well, and from so many viewpoints, that a wrong pose would
//! have been contradicted. Until then no scan enters the map: a wrong pose would soon agree with what it has drawn itself.

use crate::support::Support;

/// The score (see [`Support::score`]) that says nothing for and nothing against a pose: that of the best wrong poses.
const FAIR_SCORE: f64 = 0.8;
/// The same of the share of what the map can judge.
const FAIR_SHARE: f64 = 0.75;
/// What a viewpoint counts whose score is higher by 1.
const GAIN: f64 = 10.0;
/// The first viewpoint counts as this many.
const FIRST_VIEWS: f64 = 2.0;
/// The robot has another viewpoint after this distance, m.
const VIEW_M: f64 = 0.25;
/// At rest, a scan counts as this many viewpoints against a pose.
const LEAST_VIEWS: f64 = 0.1;
/// A pose is certain with this sum for it, and is dropped with this sum against it.
const ENOUGH: f64 = 3.0;
const TOO_MUCH: f64 = 3.0;

/// What speaks for and against a pose since it was found.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Probation {
    scans: u32,
    has_first_view: bool,
    evidence_for: f64,
    evidence_against: f64,
}

/// What has become of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Not certain yet.
    Open,
    Certain,
    Wrong,
}

impl Probation {
    /// A pose that some scans have already confirmed.
    pub(crate) fn after(scans: u32) -> Self {
        Self { scans, ..Self::default() }
    }

    /// Counts a scan, after the robot has moved by `moved_m`. A pose is certain after `least_scans` at the earliest.
    pub(crate) fn count(&mut self, support: &Support, moved_m: f64, least_scans: u32) -> Verdict {
        let is_first = !std::mem::replace(&mut self.has_first_view, true);
        let views = if is_first { FIRST_VIEWS } else { (moved_m / VIEW_M).min(1.0) };
        self.scans = self.scans.saturating_add(1);
        self.evidence_for = (self.evidence_for + views * GAIN * (support.score() - FAIR_SCORE)).max(0.0);
        let against = views.max(LEAST_VIEWS) * GAIN * (FAIR_SHARE - support.share());
        self.evidence_against = (self.evidence_against + against).max(0.0);
        if self.evidence_against >= TOO_MUCH {
            Verdict::Wrong
        } else if self.evidence_for >= ENOUGH && self.scans >= least_scans {
            Verdict::Certain
        } else {
            Verdict::Open
        }
    }
}

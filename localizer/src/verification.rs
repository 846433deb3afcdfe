//! The verification of a pose that a search has found.
//!
//! In a map that is not finished, the true place may be missing, and something in the map always looks a little like it. A
//! found pose is certain once enough scans from enough viewpoints agree with the map: those of a wrong pose would contradict
//! it. Until then no scan enters the map: a wrong pose would soon agree with what it has drawn itself.

use crate::constants::{FAIR_SHARE, MINOR};
use crate::support::Support;

/// What contradicts the map counts this many times.
const CONTRADICTION: f64 = 4.0;
/// Agreement that says nothing: near the pose by odometry, and elsewhere, where that of wrong poses was at most 0.25.
const FAIR_NEAR: f64 = 0.2;
const FAIR: f64 = 0.35;
/// Evidence of a viewpoint per agreement, for and against a pose; and the evidence that decides.
const GAIN: f64 = 4.0;
const LOSS: f64 = 20.0;
const ENOUGH: f64 = 3.0;
/// Viewpoints that the first one counts: of a laser that sees all around.
const FIRST_VIEWS: f64 = 2.0;
/// Way to another viewpoint, m.
const VIEW_M: f64 = 0.25;

/// What speaks for and against a pose since it was found.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Verification {
    scans: u32,
    has_first_view: bool,
    /// Whether the first view was near the pose that the odometry says.
    is_near: bool,
    evidence_for: f64,
    evidence_against: f64,
}

/// How far the robot has moved since the last scan, and what its laser sees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moved {
    pub(crate) way_m: f64,
    pub(crate) turn_rad: f64,
    /// The field of view as a share of a full turn, up to 1.
    pub(crate) field: f64,
}

impl Moved {
    /// The number of other viewpoints, up to 1. A robot that turns shows its laser what lay outside of its field of view.
    fn views(&self) -> f64 {
        let turned =
            (1.0 - self.field) * self.turn_rad.abs() / (std::f64::consts::TAU * self.field.max(1e-3));
        (self.way_m / VIEW_M + turned).min(1.0)
    }
}

/// The result of a verification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Not certain yet.
    Open,
    /// The robot is there.
    Certain,
    /// The robot is elsewhere.
    Wrong,
}

impl Verification {
    /// A pose that some scans have already confirmed.
    pub(crate) fn after(scans: u32) -> Self {
        Self { scans, ..Self::default() }
    }

    /// Counts a scan after a motion of the robot. A pose is certain after `min_scans` at the earliest.
    /// `is_near`: the pose is near that which the odometry says.
    pub(crate) fn count(
        &mut self,
        support: &Support,
        moved: &Moved,
        is_near: bool,
        min_scans: u32,
    ) -> Verdict {
        let is_first = !std::mem::replace(&mut self.has_first_view, true);
        self.is_near = if is_first { is_near } else { self.is_near };
        let views = if is_first { FIRST_VIEWS * moved.field } else { moved.views() };
        self.scans = self.scans.saturating_add(1);
        let (new, fair) = if self.is_near { (0.0, FAIR_NEAR) } else { (support.new, FAIR) };
        let against = CONTRADICTION * support.contradicted + new;
        let agreement = (support.confirmed - against) / support.weight().max(1e-9);
        self.evidence_for = (self.evidence_for + views * GAIN * (agreement - fair)).max(0.0);
        let against = views.max(MINOR) * LOSS * (FAIR_SHARE - support.share());
        self.evidence_against = (self.evidence_against + against).max(0.0);
        if self.evidence_against >= ENOUGH {
            Verdict::Wrong
        } else if self.evidence_for >= ENOUGH && self.scans >= min_scans {
            Verdict::Certain
        } else {
            Verdict::Open
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOVED: Moved = Moved { way_m: 0.05, turn_rad: 0.0, field: 1.0 };

    /// The verdict of scans with this support per 100 units of weight, 5 cm apart, and the number of scans up to it.
    fn verdict(confirmed: f64, contradicted: f64, is_near: bool) -> (Verdict, u32) {
        let new = 100.0 - confirmed - contradicted;
        let support = Support { confirmed, contradicted, new, ..Support::default() };
        let mut verification = Verification::after(3);
        let mut verdicts = (1..=200).map(|scan| (verification.count(&support, &MOVED, is_near, 3), scan));
        verdicts.find(|(verdict, _)| *verdict != Verdict::Open).unwrap_or((Verdict::Open, 200))
    }

    #[test]
    fn what_agrees_and_what_the_map_contradicts_decide() {
        use Verdict::{Certain, Open, Wrong};
        for (confirmed, contradicted, is_near, expected, scans) in [
            (98.0, 1.0, false, Certain, 1..=1),
            // It has to hold on the way.
            (90.0, 8.0, false, Certain, 6..=49),
            // What is new decides only far from the odometry.
            (50.0, 1.0, false, Open, 200..=200),
            (50.0, 1.0, true, Certain, 1..=200),
            (20.0, 4.0, true, Open, 200..=200),
            (60.0, 35.0, false, Wrong, 2..=59),
            (60.0, 35.0, true, Wrong, 2..=59),
        ] {
            let (verdict, after) = verdict(confirmed, contradicted, is_near);
            let is_right = verdict == expected && scans.contains(&after);
            assert!(is_right, "{confirmed} {contradicted} {is_near}: {verdict:?} after {after} scans");
        }
    }

    #[test]
    fn half_a_view_is_not_enough_at_once() {
        let support = Support { confirmed: 98.0, contradicted: 1.0, new: 1.0, ..Support::default() };
        let mut verification = Verification::after(3);
        let rests = Moved { way_m: 0.0, field: 0.5, ..MOVED };
        assert!((0..100).all(|_| verification.count(&support, &rests, false, 3) == Verdict::Open));
        // A turn by about half of the field of view shows enough.
        let turns = Moved { turn_rad: 0.2, ..rests };
        let scans = (1..100).find(|_| verification.count(&support, &turns, false, 3) == Verdict::Certain);
        assert!(scans.is_some_and(|scans| (3..30).contains(&scans)), "{scans:?}");
    }
}

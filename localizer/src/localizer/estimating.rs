//! From the predicted pose to the pose and its state.

use super::map_matcher::{MapMatcher, Step};
use super::state::{Event, State};
use crate::constants::{
    CARRIED_S, CONFIRM_SCANS, END_M, FAIR_SHARE, LIMIT_NOISE_M, MAJORITY, MIN_CONFIRMED, MIN_SUPPORT, MINOR,
    PUSHED, WIDE_GATE_M,
};
use crate::estimate::{PoseEstimate, PoseState};
use crate::faults::{Fault, mirrored};
use crate::match_scene::MatchScene;
use crate::motion::{Motion, Predicted};
use crate::support::Support;
use crate::tracking::{Tracked, track};
use crate::verification::{Moved, Verdict};
use interfaces::{Scan, Spread, heading_rad};
use nalgebra::Isometry2;
use std::f64::consts::TAU;

/// Maximum errors of a scan that enters the map: those that persist make false changes from 5 mm on (3.7 per 1000 scans of 1 cm
/// noise). The heading for surfaces seen at this lever, m, that of a scan in the middle of a room.
const MAX_STD: Spread = Spread { m: 0.005, rad: 0.003 };
const LEVER_M: f64 = 1.2;
/// The line map learns from poses that are less certain by this factor: otherwise a robot with few beams never sees the rest
/// of a new room with certainty.
const LEARNING_LIMITS: f64 = 10.0;

impl MapMatcher {
    /// Estimates the pose, and the state that follows; returns the agreement of the scan with the maps.
    pub(super) fn estimate(&mut self, step: &mut Step) -> Support {
        let scan = step.scan;
        let predicted = step.prior.map_or(scan.predicted, |prior| prior.with(scan.predicted));
        let is_first = self.from_nothing && self.surfels.is_empty();
        // Without a surface in it, a scan is as good as missing.
        let is_missing = scan.points.is_empty() && !self.surfels.is_empty();
        if scan.fault == Some(Fault::Frozen) || is_first || is_missing {
            (step.track.pose, step.track.covariance) = (predicted.pose, predicted.covariance);
            match is_first {
                true => (self.state, step.found.learns) = (State::Tracking, true),
                false => self.dead_reckon(step),
            }
            return Support::default();
        }
        step.found.begin = predicted.begin_moved();
        if self.state == State::Searching {
            return self.follow(step);
        }
        let scene = self.scene(step);
        let others = [step.track.pose, step.track.pose * step.track.last_motion];
        // A pose prior knows whether the odometry is right.
        let others = if step.prior.is_some() { &[] } else { &others[..] };
        let tracked = track(&scene, &predicted, others);
        let is_low = tracked.support.share() < MIN_SUPPORT;
        // Of a robot that is lost, the predicted pose says nothing.
        let is_mirrored = is_low && self.state != State::Lost && is_mirrored(&scene, &predicted.pose);
        match self.is_supported(&tracked) && !is_mirrored {
            true => {
                step.found.is_outlier = Some(tracked.is_other);
                self.accept(step, &tracked);
            }
            false => self.reject(step, &predicted, &tracked, is_mirrored),
        }
        tracked.support
    }

    /// Whether the scan supports a tracked pose.
    fn is_supported(&self, tracked: &Tracked) -> bool {
        let support = &tracked.support;
        let is_enough = support.share() >= self.accepted_support || tracked.stayed;
        self.state != State::Lost && is_enough && support.confirmed >= MIN_CONFIRMED
    }

    /// Takes over a supported pose.
    pub(super) fn accept(&mut self, step: &mut Step, tracked: &Tracked) {
        (step.track.pose, step.track.covariance) = (tracked.placement.pose, tracked.covariance);
        step.found.begin += tracked.placement.begin();
        step.found.follower = tracked.follower;
        if tracked.support.share() >= MIN_SUPPORT {
            self.accepted_support = MIN_SUPPORT;
        }
        let of_limits = self.of_limits(tracked);
        let is_blind = tracked.support.blind > MINOR * tracked.support.weight();
        step.found.learns = of_limits <= LEARNING_LIMITS && !is_blind;
        self.times.supported_s = self.times.now_s;
        if self.state == State::Verifying {
            self.verify(step, &tracked.support);
        }
        step.found.learns &= matches!(self.state, State::Tracking | State::Uncertain);
        self.on(if of_limits <= 1.0 && !is_blind { Event::Certain } else { Event::Imprecise });
    }

    /// The standard deviations of a pose over their limits.
    fn of_limits(&self, tracked: &Tracked) -> f64 {
        // Of the beams, since all of them enter the map.
        let (pose, covariance) = (tracked.placement.pose, tracked.beam_covariance);
        let estimate = PoseEstimate { pose, covariance, support: 1.0, state: PoseState::Uncertain };
        // An error of the heading shifts near surfaces little.
        let lever_m = tracked.support.lever_m().max(WIDE_GATE_M);
        let max_std_rad = MAX_STD.rad * (LEVER_M / lever_m).max(1.0);
        (estimate.position_std_m() / MAX_STD.m).max(estimate.heading_std_rad() / max_std_rad)
            / (self.settings.range_noise_std_m / LIMIT_NOISE_M).max(1.0)
    }

    /// Verifies a pose that was found by a search, or after a contradiction: it is not certain before.
    fn verify(&mut self, step: &Step, support: &Support) {
        let pose = &step.track.pose;
        // A robot that was carried is in a place that an unfinished map may not contain: something there looks like it.
        let is_near = !self.is_unfinished()
            && self.times.now_s - self.times.certain_s <= CARRIED_S
            && self.is_where_odometry_says(pose);
        let moved = moved(&step.scan.motion, &step.scan.reading.scan);
        match self.verification.count(support, &moved, is_near, CONFIRM_SCANS) {
            Verdict::Certain => self.on(Event::Confirmed),
            Verdict::Open => {}
            Verdict::Wrong => {
                self.times.supported_s = f64::NEG_INFINITY;
                self.ignores_prior = step.prior.is_some();
                self.on(Event::Refuted);
            }
        }
    }

    /// Doubts a pose that the scan does not support, and searches for another one.
    fn reject(&mut self, step: &mut Step, predicted: &Predicted, tracked: &Tracked, is_mirrored: bool) {
        if self.is_unfinished() && !is_mirrored && tracked.support.seen_share() < FAIR_SHARE {
            self.on(Event::Contradicted);
        }
        // A scan of which most fits says more than the odometry alone.
        let is_followed = tracked.support.share() >= MAJORITY && !is_mirrored;
        (step.track.pose, step.track.covariance) = match is_followed {
            true => (tracked.placement.pose, tracked.covariance),
            false => (predicted.pose, predicted.covariance),
        };
        self.doubt();
        match step.prior {
            _ if is_mirrored => {}
            Some(_) => self.doubt_prior(step, tracked),
            None => self.search(step, tracked),
        }
    }

    /// Whether a pose is near that which the odometry says since the last certain pose, at any time.
    pub(super) fn is_where_odometry_says(&self, pose: &Isometry2<f64>) -> bool {
        PUSHED.contains(&self.by_odometry.inv_mul(pose))
    }
}

fn moved(motion: &Motion, scan: &Scan) -> Moved {
    Moved {
        way_m: motion.delta.translation.vector.norm(),
        turn_rad: heading_rad(&motion.delta),
        field: (scan.angle_increment_rad.abs() * scan.ranges_m.len() as f64 / TAU).min(1.0),
    }
}

/// Whether the scan fits much better upside down: the laser hangs the wrong way around.
fn is_mirrored(scene: &MatchScene, pose: &Isometry2<f64>) -> bool {
    let points = mirrored(scene.points, &scene.mount);
    let scene = MatchScene { points: &points, ..*scene };
    let found = scene.align(pose, None, END_M, false);
    found.is_some_and(|found| scene.judge(&found.placement).share() >= MIN_SUPPORT)
}

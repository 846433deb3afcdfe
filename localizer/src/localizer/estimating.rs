//! From the prediction by odometry to the pose and its state.

use super::Localizer;
use crate::changing_map::ChangingMap;
use crate::estimate::{PoseEstimate, PoseState};
use crate::faults::{Fault, mirrored};
use crate::motion::Motion;
use crate::scene::Scene;
use crate::settings::LocalizerSettings;
use crate::support::Support;
use crate::tracking::{Tracked, track};
use crate::verification::{Moved, Verdict, Verification};
use interfaces::{LaserReading, Scan, heading_rad};
use nalgebra::Isometry2;
use std::f64::consts::TAU;

/// The line map also learns from scans whose pose is less certain than a map of changes tolerates, by this factor:
/// otherwise a robot that turns into a new room with few beams, or drives along a corridor, would never see the rest of it
/// with certainty, and would lose what it sees.
const LEARNING_LIMITS: f64 = 10.0;
/// The least confirmed weight of a certain pose: about a metre of wall.
pub(super) const LEAST_CONFIRMED: f64 = 8.0;
/// The number of scans for which the odometry is not trusted after it did not tell the truth.
const DISTRUST_SCANS: u32 = 20;
/// Up to this long after the last certain pose, the odometry says where the robot is: up to these differences, m and rad,
/// since a robot may be pushed or carried.
const NEAR_S: f64 = 10.0;
const NEAR_M: f64 = 1.5;
const NEAR_RAD: f64 = 1.3;
/// The least support with which a pose that is not certain is followed.
pub(super) const LEAST_GUIDE: f64 = 0.5;
/// The least support of a scan after which a pose is certain again without a verification: where less of a scan agrees, the
/// robot may have been carried, and would soon agree with what it draws itself.
const LEAST_UNVERIFIED: f64 = 0.7;
/// The match of a mirrored scan starts up to this far from the pose, m.
const MIRRORED_GATE_M: f64 = 0.2;
/// The largest share of a scan without a return where the map knows something blocked: beyond, the laser is covered.
const MOST_BLIND: f64 = 0.1;
/// The lever of the seen surfaces for which the limit of the heading holds, m: that of a scan in the middle of a room. Of
/// nearer surfaces, it may be exceeded in proportion, down to the least lever (m).
const LEVER_M: f64 = 1.2;
const LEAST_LEVER_M: f64 = 0.3;
/// The range noise for which the limits of the standard deviations hold, m. A map of a laser with more noise tolerates
/// larger errors of the pose.
const NOISE_M: f64 = 0.01;

impl Localizer {
    /// Estimates the pose, and the state that follows; returns the agreement of the scan with the maps.
    pub(super) fn estimate(
        &mut self,
        reading: &LaserReading,
        motion: &Motion,
        map: &impl ChangingMap,
        fault: Option<Fault>,
    ) -> Support {
        let predicted = motion.predict(&self.pose, &self.covariance, reading.scan.sweep_s > 0.0);
        let predicted = self.guided(predicted);
        self.begin = predicted.begin_moved();
        let is_first = self.from_nothing && self.surfels.is_empty();
        if fault == Some(Fault::Frozen) || is_first {
            (self.pose, self.covariance) = (predicted.pose, predicted.covariance);
            self.state = if is_first { PoseState::Tracking } else { PoseState::Uncertain };
            self.learns = is_first;
            return Support::default();
        }
        if !self.hypotheses.is_empty() {
            return self.follow(reading, motion, map);
        }
        let others = [self.pose, self.pose * self.last_motion];
        let scene = self.scene(reading, map);
        // A guide knows whether the odometry told the truth.
        let others = if self.guide.is_some() { &[] } else { &others[..] };
        let tracked = track(&scene, &predicted, others);
        let is_low = tracked.support.share() < self.settings.min_support;
        let is_mirrored = is_low && is_mirrored(&scene, &predicted.pose, reading);
        if self.is_supported(&tracked) && !is_mirrored {
            let support = tracked.support;
            self.follower = tracked.follower;
            self.distrust = if tracked.is_other { DISTRUST_SCANS } else { self.distrust.saturating_sub(1) };
            self.accept(&tracked);
            self.verify(&support, motion, &reading.scan);
            return support;
        }
        if self.is_unfinished() && !is_mirrored && tracked.support.seen_share() < LEAST_UNVERIFIED {
            self.verification = Some(Verification::default());
        }
        // A scan of which most fits is a better guide than the odometry alone.
        let is_guide = tracked.support.share() >= LEAST_GUIDE && !is_mirrored;
        (self.pose, self.covariance) = if is_guide {
            (tracked.placement.pose, tracked.covariance)
        } else {
            (predicted.pose, predicted.covariance)
        };
        self.doubt();
        match self.guide {
            _ if is_mirrored => {}
            Some(_) => self.doubt_guide(reading, map, &tracked),
            None => self.search(reading, motion, map, &tracked),
        }
        tracked.support
    }

    pub(super) fn scene<'a, M: ChangingMap>(&'a self, reading: &LaserReading, map: &'a M) -> Scene<'a, M> {
        Scene {
            surfels: &self.surfels,
            map,
            points: self.points.points(),
            clear: &self.clear,
            mount: reading.mount,
            settings: &self.settings,
            is_tight: false,
        }
    }

    /// Whether the scan supports a tracked pose.
    fn is_supported(&self, tracked: &Tracked) -> bool {
        let support = &tracked.support;
        let is_enough = support.share() >= self.accepted_support || tracked.stayed;
        self.state != PoseState::Lost && is_enough && support.confirmed >= LEAST_CONFIRMED
    }

    /// Takes over a supported pose.
    pub(super) fn accept(&mut self, tracked: &Tracked) {
        (self.pose, self.covariance) = (tracked.placement.pose, tracked.covariance);
        self.begin += tracked.placement.begin();
        if tracked.support.share() >= self.settings.min_support {
            self.accepted_support = self.settings.min_support;
        }
        // Of the beams, since all of them enter the map.
        let estimate = PoseEstimate { covariance: tracked.beam_covariance, ..self.pose_estimate(1.0) };
        let scale = (self.settings.range_noise_std_m / NOISE_M).max(1.0);
        let LocalizerSettings { max_position_std_m, max_heading_std_rad, .. } = self.settings;
        // An error of the heading shifts near surfaces little.
        let lever_m = tracked.support.lever_m().max(LEAST_LEVER_M);
        let max_heading_std_rad = max_heading_std_rad * (LEVER_M / lever_m).max(1.0);
        let of_limits = (estimate.position_std_m() / max_position_std_m)
            .max(estimate.heading_std_rad() / max_heading_std_rad)
            / scale;
        let is_blind = tracked.support.blind > MOST_BLIND * tracked.support.weight();
        let is_certain = of_limits <= 1.0 && !is_blind;
        self.state = if is_certain { PoseState::Tracking } else { PoseState::Uncertain };
        self.learns = of_limits <= LEARNING_LIMITS && !is_blind;
        self.supported_s = Some(self.time_s);
    }

    /// Verifies a pose that was found by a search, or after a contradiction: it is not certain before.
    pub(super) fn verify(&mut self, support: &Support, motion: &Motion, scan: &Scan) {
        let is_near = self.is_near_odometry();
        let Some(verification) = &mut self.verification else { return };
        let moved = Moved {
            way_m: motion.delta.translation.vector.norm(),
            turn_rad: heading_rad(&motion.delta),
            field: (scan.angle_increment_rad.abs() * scan.ranges_m.len() as f64 / TAU).min(1.0),
        };
        match verification.count(support, &moved, is_near, self.settings.scans_to_confirm) {
            Verdict::Certain => {
                self.verification = None;
                return;
            }
            Verdict::Open => self.state = PoseState::Uncertain,
            Verdict::Wrong => {
                (self.verification, self.supported_s) = (None, None);
                (self.state, self.ignores_guide) = (PoseState::Lost, self.guide.is_some());
            }
        }
        self.learns = false;
    }

    /// Whether the true place may be missing in the map: in one that the robot has made itself, since it knows where it is. At
    /// the begin of another session, the robot is somewhere in the map.
    pub(super) fn is_unfinished(&self) -> bool {
        self.from_nothing && self.certain_s > f64::NEG_INFINITY
    }

    /// Whether the pose is near that which the odometry says since the last certain pose.
    fn is_near_odometry(&self) -> bool {
        self.time_s - self.certain_s <= NEAR_S && self.is_where_odometry_says(&self.pose)
    }

    /// Whether a pose is near that which the odometry says since the last certain pose, at any time.
    pub(super) fn is_where_odometry_says(&self, pose: &Isometry2<f64>) -> bool {
        let off = self.by_odometry.inv_mul(pose);
        off.translation.vector.norm() <= NEAR_M && heading_rad(&off).abs() <= NEAR_RAD
    }

    /// The pose is not certain; after some time, it is lost.
    pub(super) fn doubt(&mut self) {
        let limit_s = self.settings.lost_after_s;
        let is_lost = self
            .supported_s
            .map_or(self.state == PoseState::Lost, |supported_s| self.time_s - supported_s > limit_s);
        self.state = if is_lost { PoseState::Lost } else { PoseState::Uncertain };
    }
}

/// Whether the scan fits much better upside down: the laser hangs the wrong way around.
fn is_mirrored<M: ChangingMap>(scene: &Scene<M>, pose: &Isometry2<f64>, reading: &LaserReading) -> bool {
    let points = mirrored(scene.points, &reading.mount);
    let scene = Scene { points: &points, ..*scene };
    let found = scene.align(pose, None, MIRRORED_GATE_M, false);
    found.is_some_and(|found| scene.judge(&found.placement).share() >= scene.settings.min_support)
}

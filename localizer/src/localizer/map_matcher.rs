//! Matches scans with the line map of the place: from the predicted pose to the pose and its state.

use super::relocalizing::{MIN_FOLLOWED, Relocalization};
use super::state::{Event, State};
use super::{LOST_STD_M, LOST_STD_RAD, PosePrior};
use crate::changing_map::ChangingMap;
use crate::estimate::{PoseEstimate, PoseState, Start};
use crate::faults::{Fault, mirrored};
use crate::local_trajectory_builder::{IncomingScan, Matched, ScanMatcher, Track};
use crate::motion::{Motion, Predicted};
use crate::scene::{Scene, exact_m};
use crate::settings::LocalizerSettings;
use crate::support::{ClearBeams, Support};
use crate::surfel_map::{Checker, SurfelMap};
use crate::tracking::{Tracked, track};
use crate::verification::{Moved, Verdict, Verification};
use interfaces::{Scan, heading_rad};
use nalgebra::{Isometry2, Matrix3, Vector3};
use std::f64::consts::TAU;

/// The number of scans between two updates of the weights by rates.
const RATES_EVERY: u32 = 100;
/// The line map also learns from scans whose pose is less certain than a map of changes tolerates, by this factor:
/// otherwise a robot that turns into a new room with few beams, or drives along a corridor, would never see the rest of it
/// with certainty, and would lose what it sees.
const LEARNING_LIMITS: f64 = 10.0;
/// The least confirmed weight of a certain pose: about a metre of wall.
pub(super) const MIN_CONFIRMED: f64 = 8.0;
/// Up to this long after the last certain pose, the odometry says where the robot is: up to these differences, m and rad,
/// since a robot may be pushed or carried.
const NEAR_S: f64 = 10.0;
const NEAR_M: f64 = 1.5;
const NEAR_RAD: f64 = 1.3;
/// The least support of a scan after which a pose is certain again without a verification: where less of a scan agrees, the
/// robot may have been carried, and would soon agree with what it draws itself.
const MIN_UNVERIFIED: f64 = 0.7;
/// The match of a mirrored scan starts up to this far from the pose, m.
const MIRRORED_GATE_M: f64 = 0.2;
/// The largest share of a scan without a return where the map knows something blocked: beyond, the laser is covered.
const MAX_BLIND: f64 = 0.1;
/// The lever of the seen surfaces for which the limit of the heading holds, m: that of a scan in the middle of a room. Of
/// nearer surfaces, it may be exceeded in proportion, down to the least lever (m).
const LEVER_M: f64 = 1.2;
const MIN_LEVER_M: f64 = 0.3;
/// The range noise for which the limits of the standard deviations hold, m. A map of a laser with more noise tolerates
/// larger errors of the pose.
const NOISE_M: f64 = 0.01;

/// What the map of changes and another source know.
pub(super) struct Around<'a, M> {
    pub(super) map: &'a M,
    pub(super) prior: Option<PosePrior>,
}

impl<M> Clone for Around<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<M> Copy for Around<'_, M> {}

/// The values of one scan.
pub(super) struct Step<'a, M> {
    pub(super) scan: &'a IncomingScan,
    pub(super) map: &'a M,
    pub(super) prior: Option<PosePrior>,
    pub(super) clear: &'a ClearBeams,
    pub(super) track: &'a mut Track,
    pub(super) found: MapFound,
}

/// What a match with the line map says beside the pose.
#[derive(Default)]
pub(super) struct MapFound {
    /// See [`PoseEstimate::support`].
    pub(super) support: f64,
    /// If much of the view has moved at once: the pose of a robot that follows it.
    pub(super) follower: Option<Isometry2<f64>>,
    /// Whether the odometry is an outlier, where the scan supports the pose.
    is_outlier: Option<bool>,
    /// How far the robot was from its last pose, as the scan shows: x, y (m) and heading (rad).
    begin: Vector3<f64>,
    /// Whether the scan may enter the line map.
    learns: bool,
}

/// The line map, and where the robot is in it.
#[derive(Clone, Debug)]
pub(crate) struct MapMatcher {
    pub(super) settings: LocalizerSettings,
    pub(super) surfels: SurfelMap,
    pub(super) checker: Checker,
    pub(super) state: State,
    /// In the state of verification: what speaks for the pose and against it.
    pub(super) verification: Verification,
    pub(super) relocalization: Relocalization,
    pub(super) times: Times,
    /// Where the robot is by odometry since its last certain pose.
    pub(super) by_odometry: Isometry2<f64>,
    /// The support below which the pose is searched for: lower where a search has confirmed a low support.
    pub(super) accepted_support: f64,
    /// Whether the robot started without a map.
    pub(super) from_nothing: bool,
    /// Whether no pose prior is followed: the last one was wrong, or a search has found another pose. Until the next certain
    /// pose, or until nothing is left of what was found.
    pub(super) ignores_prior: bool,
}

/// The times of a localizer, s.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
pub(super) struct Times {
    pub(super) start_s: Option<f64>,
    pub(super) now_s: f64,
    /// When a scan has last supported the pose; positive infinity: the first pose is known, negative infinity: no pose is.
    pub(super) supported_s: f64,
    /// When a pose was last certain.
    pub(super) certain_s: f64,
    /// The number of readings.
    pub(super) readings: u32,
}

impl MapMatcher {
    pub(super) fn new(
        settings: &LocalizerSettings,
        surfels: SurfelMap,
        start: Start,
        from_nothing: bool,
    ) -> Self {
        let (by_odometry, state, supported_s) = match start {
            Start::At(pose) => (pose, State::Tracking, f64::INFINITY),
            Start::Unknown => (Isometry2::identity(), State::Lost, f64::NEG_INFINITY),
        };
        let certain_s = f64::NEG_INFINITY;
        Self {
            settings: settings.clone(),
            surfels,
            checker: Checker::default(),
            state,
            verification: Verification::default(),
            relocalization: Relocalization::default(),
            times: Times { start_s: None, now_s: 0.0, supported_s, certain_s, readings: 0 },
            by_odometry,
            accepted_support: settings.min_support,
            from_nothing,
            ignores_prior: false,
        }
    }

    /// Begins another session in the map that was learned. Returns the covariance of the pose if the robot can be anywhere.
    pub(super) fn begin_session(&mut self) -> Option<Matrix3<f64>> {
        self.relocalization = Relocalization::default();
        (self.ignores_prior, self.accepted_support) = (false, self.settings.min_support);
        let is_empty = self.surfels.is_empty();
        let supported_s = if is_empty { f64::INFINITY } else { f64::NEG_INFINITY };
        // A robot that is lost looks around; it does not rest.
        let start_s = if is_empty { None } else { Some(f64::NEG_INFINITY) };
        let certain_s = f64::NEG_INFINITY;
        self.times = Times { start_s, supported_s, certain_s, readings: 0, ..self.times };
        if is_empty {
            return None;
        }
        self.state = State::Lost;
        let std = Vector3::new(LOST_STD_M, LOST_STD_M, LOST_STD_RAD);
        Some(Matrix3::from_diagonal(&std.component_mul(&std)))
    }

    pub(super) fn wants_rest(&self) -> bool {
        let elapsed_s = self.times.start_s.map_or(0.0, |start_s| self.times.now_s - start_s);
        self.from_nothing && elapsed_s < self.settings.settle_s
    }

    pub(super) fn reported(&self) -> PoseState {
        self.state.reported(self.is_timed_out())
    }

    fn is_timed_out(&self) -> bool {
        self.times.now_s - self.times.supported_s > self.settings.lost_after_s
    }

    /// Changes the state.
    pub(super) fn on(&mut self, event: Event) {
        let before = self.state;
        self.state = before.after(event);
        let begins = self.state == State::Verifying && (before != self.state || event == Event::Contradicted);
        if begins {
            self.verification = Verification::default();
            if !self.is_unfinished() {
                self.on(Event::Confirmed);
            }
        }
    }

    /// The pose is not certain; after some time, it is lost.
    pub(super) fn doubt(&mut self) {
        self.on(Event::Unsupported);
        if self.is_timed_out() {
            self.on(Event::TimedOut);
        }
    }

    /// Whether the true place may be missing in the map: in one that the robot has made itself, since it knows where it is. At
    /// the begin of another session, the robot is somewhere in the map.
    fn is_unfinished(&self) -> bool {
        self.from_nothing && self.times.certain_s > f64::NEG_INFINITY
    }

    pub(super) fn scene<'a, M: ChangingMap>(&'a self, step: &Step<'a, M>) -> Scene<'a, M> {
        Scene {
            surfels: &self.surfels,
            map: step.map,
            points: &step.scan.points,
            clear: step.clear,
            mount: step.scan.reading.mount,
            settings: &self.settings,
            is_tight: false,
        }
    }
}

impl<'a, M: ChangingMap> ScanMatcher<Around<'a, M>> for MapMatcher {
    type Found = MapFound;

    fn matched(
        &mut self,
        scan: &IncomingScan,
        track: &mut Track,
        around: Around<'a, M>,
    ) -> Matched<Self::Found> {
        self.times.now_s = scan.now_s;
        self.times.start_s.get_or_insert(scan.now_s);
        self.weigh_by_rates(around.map);
        self.by_odometry = scan.motion.apply(&self.by_odometry);
        let was_tracking = self.state == State::Tracking;
        let prior = around.prior.filter(|_| !self.ignores_prior);
        if prior.is_some() {
            self.relocalization.forget();
            self.on(Event::Located);
        }
        let clear = ClearBeams::of(&scan.reading.scan);
        let found = MapFound::default();
        let mut step = Step { scan, map: around.map, prior, clear: &clear, track, found };
        let support = self.estimate(&mut step);
        let Step { track, mut found, .. } = step;
        found.support = support.share();
        if self.state == State::Tracking {
            (self.by_odometry, self.times.certain_s) = (track.pose, self.times.now_s);
            self.ignores_prior = false;
            self.relocalization.end_wide();
        }
        let is_reliable = was_tracking && self.state == State::Tracking;
        if scan.fault.is_some() && self.state == State::Tracking {
            self.on(Event::Unsupported);
            found.learns = false;
        }
        Matched { begin: found.begin, is_reliable, is_outlier: found.is_outlier, found }
    }

    fn insert(&mut self, scan: &IncomingScan, track: &Track, found: &MapFound, _: Around<'a, M>) {
        if !found.learns {
            return;
        }
        let (points, noise_m) = (&scan.points, self.settings.range_noise_std_m);
        if let Some(follower) = &found.follower {
            self.surfels.displace_all(points, &track.pose, follower, exact_m(noise_m));
        }
        match self.state {
            State::Tracking => self.surfels.learn(points, &track.pose, noise_m),
            _ => self.surfels.learn_uncertain(points, &track.pose, noise_m),
        }
        self.checker.check(&mut self.surfels, &scan.reading, &track.pose);
    }
}

impl MapMatcher {
    fn weigh_by_rates(&mut self, map: &impl ChangingMap) {
        let (readings, horizon_s) = (&mut self.times.readings, self.settings.rate_horizon_s);
        *readings = readings.wrapping_add(1);
        // At the first reading, a known map may bring rates.
        let is_due = *readings == 1 || readings.is_multiple_of(RATES_EVERY);
        if is_due && horizon_s > 0.0 {
            self.surfels.weigh_by_rates(map, horizon_s);
        }
    }

    /// Estimates the pose, and the state that follows; returns the agreement of the scan with the maps.
    fn estimate<M: ChangingMap>(&mut self, step: &mut Step<M>) -> Support {
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
        let is_low = tracked.support.share() < self.settings.min_support;
        let is_mirrored = is_low && is_mirrored(&scene, &predicted.pose);
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
    pub(super) fn accept<M: ChangingMap>(&mut self, step: &mut Step<M>, tracked: &Tracked) {
        (step.track.pose, step.track.covariance) = (tracked.placement.pose, tracked.covariance);
        step.found.begin += tracked.placement.begin();
        step.found.follower = tracked.follower;
        if tracked.support.share() >= self.settings.min_support {
            self.accepted_support = self.settings.min_support;
        }
        let of_limits = self.of_limits(tracked);
        let is_blind = tracked.support.blind > MAX_BLIND * tracked.support.weight();
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
        let LocalizerSettings { max_position_std_m, max_heading_std_rad, range_noise_std_m, .. } =
            self.settings;
        // Of the beams, since all of them enter the map.
        let (pose, covariance) = (tracked.placement.pose, tracked.beam_covariance);
        let estimate = PoseEstimate { pose, covariance, support: 1.0, state: PoseState::Uncertain };
        // An error of the heading shifts near surfaces little.
        let lever_m = tracked.support.lever_m().max(MIN_LEVER_M);
        let max_heading_std_rad = max_heading_std_rad * (LEVER_M / lever_m).max(1.0);
        (estimate.position_std_m() / max_position_std_m).max(estimate.heading_std_rad() / max_heading_std_rad)
            / (range_noise_std_m / NOISE_M).max(1.0)
    }

    /// Verifies a pose that was found by a search, or after a contradiction: it is not certain before.
    fn verify<M>(&mut self, step: &Step<M>, support: &Support) {
        let pose = &step.track.pose;
        let is_near = self.times.now_s - self.times.certain_s <= NEAR_S && self.is_where_odometry_says(pose);
        let moved = moved(&step.scan.motion, &step.scan.reading.scan);
        match self.verification.count(support, &moved, is_near, self.settings.scans_to_confirm) {
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
    fn reject<M: ChangingMap>(
        &mut self,
        step: &mut Step<M>,
        predicted: &Predicted,
        tracked: &Tracked,
        is_mirrored: bool,
    ) {
        if self.is_unfinished() && !is_mirrored && tracked.support.seen_share() < MIN_UNVERIFIED {
            self.on(Event::Contradicted);
        }
        // A scan of which most fits says more than the odometry alone.
        let is_followed = tracked.support.share() >= MIN_FOLLOWED && !is_mirrored;
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
        let off = self.by_odometry.inv_mul(pose);
        off.translation.vector.norm() <= NEAR_M && heading_rad(&off).abs() <= NEAR_RAD
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
fn is_mirrored<M: ChangingMap>(scene: &Scene<M>, pose: &Isometry2<f64>) -> bool {
    let points = mirrored(scene.points, &scene.mount);
    let scene = Scene { points: &points, ..*scene };
    let found = scene.align(pose, None, MIRRORED_GATE_M, false);
    found.is_some_and(|found| scene.judge(&found.placement).share() >= scene.settings.min_support)
}

//! Matches scans with the line map of the place, and inserts them in it.

mod relocalizing;

use super::state::{Event, State};
use crate::changing_map::ChangingMap;
use crate::constants::{LOST_STD, MIN_SUPPORT, USABLE_SCANS};
use crate::estimate::Start;
use crate::hypotheses::Hypotheses;
use crate::local_trajectory_builder::{IncomingScan, Matched, ScanMatcher, Track};
use crate::match_scene::{MatchScene, exact_m};
use crate::motion::Predicted;
use crate::settings::LocalizerSettings;
use crate::support::ClearBeams;
use crate::surfel_map::{Checker, SurfelMap};
use crate::verification::Verification;
use interfaces::{CellState, Grid};
use nalgebra::{Isometry2, Matrix3, Vector3};
use relocalizing::Relocalization;

/// Scans between two updates of the weights by rates.
const RATES_EVERY: u32 = 100;
/// Learned rates of change lower the weight of a surface in a search by exp(−rate · horizon), s.
const RATE_HORIZON_S: f64 = 1000.0;

/// The map of changes, and what another source knows.
type Around<'a> = (&'a dyn ChangingMap, Option<Predicted>);

/// The values of one scan.
pub(super) struct Step<'a> {
    pub(super) scan: &'a IncomingScan,
    pub(super) states: &'a Grid<CellState>,
    pub(super) prior: Option<Predicted>,
    pub(super) clear: &'a ClearBeams,
    pub(super) track: &'a mut Track,
    pub(super) found: MapFound,
}

/// What a match with the line map says beside the pose.
#[derive(Default)]
pub(crate) struct MapFound {
    /// See [`PoseEstimate::support`].
    pub(super) support: f64,
    /// If much of the view has moved at once: the pose of a robot that follows it.
    pub(super) follower: Option<Isometry2<f64>>,
    /// Whether the odometry is an outlier, where the scan supports the pose.
    pub(super) is_outlier: Option<bool>,
    /// How far the robot was from its last pose, as the scan shows: x, y (m) and heading (rad).
    pub(super) begin: Vector3<f64>,
    /// Whether the scan may enter the line map.
    pub(super) learns: bool,
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
            accepted_support: MIN_SUPPORT,
            from_nothing,
            ignores_prior: false,
        }
    }

    /// Begins another session in the map that was learned. Returns the covariance of the pose if the robot can be anywhere.
    pub(super) fn begin_session(&mut self) -> Option<Matrix3<f64>> {
        self.relocalization = Relocalization::default();
        (self.ignores_prior, self.accepted_support) = (false, MIN_SUPPORT);
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
        Some(LOST_STD.covariance())
    }

    /// Follows a pose that another source has given, and that is not certain yet.
    pub(super) fn seat(&mut self, pose: Isometry2<f64>) {
        self.relocalization = Relocalization::default();
        self.verification = Verification::default();
        (self.ignores_prior, self.accepted_support) = (false, MIN_SUPPORT);
        (self.by_odometry, self.times.supported_s) = (pose, self.times.now_s);
        self.state = State::Uncertain;
    }

    pub(super) fn is_timed_out(&self) -> bool {
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

    /// Whether the true place may be missing in the map: in one that the robots have made themselves, in any session.
    pub(super) fn is_unfinished(&self) -> bool {
        self.from_nothing
    }

    pub(super) fn scene<'a>(&'a self, step: &Step<'a>) -> MatchScene<'a> {
        MatchScene {
            surfels: &self.surfels,
            states: step.states,
            points: &step.scan.points,
            clear: step.clear,
            mount: step.scan.reading.mount,
            settings: &self.settings,
            is_tight: false,
        }
    }
}

impl<'a> ScanMatcher<Around<'a>> for MapMatcher {
    type Found = MapFound;

    fn matched(
        &mut self,
        scan: &IncomingScan,
        track: &mut Track,
        (map, prior): Around<'a>,
    ) -> Matched<Self::Found> {
        self.times.now_s = scan.now_s;
        self.times.start_s.get_or_insert(scan.now_s);
        self.times.readings = self.times.readings.wrapping_add(1);
        // At the first reading, a known map may bring rates.
        if self.times.readings == 1 || self.times.readings.is_multiple_of(RATES_EVERY) {
            self.surfels.weigh_by_rates(map, RATE_HORIZON_S);
        }
        self.by_odometry = scan.motion.apply(&self.by_odometry);
        if let Some(wide) = &mut self.relocalization.wide {
            wide.follow_odometry(&scan.motion);
        }
        let was_tracking = self.state == State::Tracking;
        let prior = prior.filter(|_| !self.ignores_prior);
        if prior.is_some() {
            self.relocalization.hypotheses = Hypotheses::default();
            self.on(Event::Located);
        }
        let clear = ClearBeams::of(&scan.reading.scan);
        let found = MapFound::default();
        let mut step = Step { scan, states: map.states(), prior, clear: &clear, track, found };
        let support = self.estimate(&mut step);
        let Step { track, mut found, .. } = step;
        found.support = support.share();
        if self.state == State::Tracking {
            (self.by_odometry, self.times.certain_s) = (track.pose, self.times.now_s);
            self.ignores_prior = false;
            self.relocalization.wide = None;
        }
        let is_reliable = was_tracking && self.state == State::Tracking;
        if scan.fault.is_some() && self.state == State::Tracking {
            self.on(Event::Unsupported);
            found.learns = false;
        }
        Matched { begin: found.begin, is_reliable, is_outlier: found.is_outlier, found }
    }

    fn insert(&mut self, scan: &IncomingScan, track: &Track, found: &MapFound, _: Around<'a>) {
        if !found.learns {
            return;
        }
        let (points, noise_m) = (&scan.points, self.settings.range_noise_std_m);
        if let Some(follower) = &found.follower {
            self.surfels.displace_all(points, &track.pose, follower, exact_m(noise_m));
        }
        // All that follows is matched with the first scan.
        let scans = if self.surfels.is_empty() { USABLE_SCANS } else { 1 };
        self.surfels.learn(points, &track.pose, noise_m, scans, self.state == State::Tracking);
        self.checker.check(&mut self.surfels, &scan.reading, &track.pose);
    }
}

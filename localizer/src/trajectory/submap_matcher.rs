//! Matches scans with the submap of the last keyframes, and makes keyframes of them.

use super::correlation::{found_among, matched_at};
use super::distance_scale::MeasuredMotion;
use super::submap::{
    Agreement, FinishedSubmap, GrowingSubmap, KEPT_POINTS, Keyframe, agreement, filled, gates, in_frame,
    motion_spread, thinned,
};
use crate::constants::{
    FAIR_SHARE, FOUND_STD, JUDGED_M, KEYFRAME, KEYFRAME_STD, MAJORITY, MAX_WORK, MIN_AGREEMENT, MIN_OVERLAP,
    MIN_RESPONSE, SCAN_STD, SUBMAP_KEYFRAMES, SURFEL_M,
};
use crate::faults::Fault;
use crate::local_trajectory_builder::{IncomingScan, Matched, ScanMatcher, Track};
use crate::matcher::{Match, Prior, align};
use crate::motion::Motion;
use crate::scan_points::ScanPoint;
use crate::score_grid::ScoreGrid;
use crate::search::{Window, search};
use crate::surfel_map::SurfelMap;
use interfaces::{LaserReading, Spread};
use nalgebra::{Isometry2, Matrix3, Vector3};
use std::collections::VecDeque;

/// Minimum number of points on a submap.
const MIN_POINTS: usize = 12;
/// Where less agrees: turns that are tried, rad (a laser out of step with the odometry), then a search.
const OTHER_TURNS_RAD: [f64; 3] = [0.08, 0.16, 0.25];
const MIN_SHARE: f64 = 0.3;
const SEARCHED: Spread = Spread { m: 0.8, rad: 0.4 };
/// Errors of the prediction in a search: along a corridor nothing but the odometry says how far the robot went.
const SEARCHED_STD: Spread = Spread { m: 0.05, rad: 0.3 };
/// Another pose must confirm more by this factor.
const CLEARLY: f64 = 1.15;
/// Errors of a motion without odometry, and without a match.
const MISSING_STD: Spread = Spread::of_motion(0.3);
/// A motion between two scans after which the robot has another viewpoint.
const FAR_SCAN: Spread = Spread { m: 0.3, rad: 0.3 };

/// While its laser starts, a robot does not drive farther than this, m.
const START_M: f64 = 1.0;

/// The submaps that grow, and their keyframes.
#[derive(Debug, Default)]
pub(crate) struct SubmapMatcher {
    noise_m: f64,
    /// The motion by odometry since the last keyframe.
    since_keyframe: Isometry2<f64>,
    /// The same motion as it was measured, without what was learned of the odometry.
    measured: Isometry2<f64>,
    /// The motions between keyframes that the odometry measured, and scans.
    pub(super) measured_motions: Vec<MeasuredMotion>,
    pub(super) keyframes: Vec<Keyframe>,
    /// The older one is matched with, the younger one is only filled.
    growing: Vec<GrowingSubmap>,
    pub(super) finished: VecDeque<FinishedSubmap>,
    /// Whether the last scan shows no surface.
    pub(super) sees_nothing: bool,
    /// Whether any scan so far shows a surface.
    has_seen: bool,
}

/// What a match with a submap says beside the pose.
pub(crate) struct SubmapFound {
    /// The match; `None` if there is nothing to match with.
    matched: Option<SubmapMatch>,
    /// Whether the submap supports the pose.
    pub(super) is_supported: bool,
    is_frozen: bool,
}

/// The result of a match with a submap.
struct SubmapMatch {
    found: Match,
    agreement: Agreement,
}

impl SubmapMatch {
    /// Whether less of the scan agrees: of what the submap can judge, or of all.
    fn is_below(&self, agreement: f64, share: f64) -> bool {
        self.agreement.share() < agreement || self.agreement.confirmed < share * self.agreement.all
    }
}

impl ScanMatcher<()> for SubmapMatcher {
    type Found = SubmapFound;

    fn matched(&mut self, scan: &IncomingScan, track: &mut Track, (): ()) -> Matched<SubmapFound> {
        self.since_keyframe *= scan.motion.delta;
        self.measured *= scan.measured;
        self.measured.rotation.renormalize();
        self.since_keyframe.rotation.renormalize();
        self.sees_nothing = scan.points.is_empty();
        (track.pose, track.covariance) = (scan.predicted.pose, scan.predicted.covariance);
        // The first scan that shows a surface is right by definition: some lasers see nothing while they start.
        let is_first = !self.has_seen && (!self.sees_nothing || self.is_at_start(&track.pose));
        let is_frozen = scan.fault == Some(Fault::Frozen) && !is_first;
        // From another viewpoint than the scan before.
        let is_far = !is_frozen && !FAR_SCAN.contains(&scan.motion.delta);
        let matched = match is_far {
            _ if is_frozen || is_first => None,
            true => self.match_far(scan),
            false => self.match_submap(scan, track),
        };
        let min_share = if is_far { MIN_RESPONSE } else { FAIR_SHARE };
        let (mut begin, mut agreement, mut is_reliable) = (Vector3::zeros(), 0.0, false);
        if let Some(matched) = &matched {
            let Match { placement, information, .. } = &matched.found;
            (begin, track.pose) = (placement.begin(), placement.pose);
            track.covariance =
                information.try_inverse().unwrap_or_else(|| FOUND_STD.covariance()) + SCAN_STD.covariance();
            agreement = matched.agreement.share();
            is_reliable = !matched.is_below(MIN_AGREEMENT, MAJORITY);
        }
        if is_first && !self.keyframes.is_empty() {
            // The next scan is compared with this one: the motion since the begin says nothing about it.
            track.covariance = Matrix3::zeros();
        }
        let is_supported = is_first || agreement >= min_share;
        let found = SubmapFound { matched, is_supported, is_frozen };
        Matched { begin, is_reliable, is_outlier: None, found }
    }

    fn insert(&mut self, scan: &IncomingScan, track: &Track, found: &SubmapFound, (): ()) {
        let offset = self.offset(track);
        let is_far = !KEYFRAME.contains(&offset);
        let is_first = self.keyframes.is_empty() || !self.has_seen && !self.sees_nothing;
        self.has_seen |= !self.sees_nothing;
        if is_first || is_far && !found.is_frozen {
            let found = found.matched.as_ref().map(|matched| &matched.found);
            self.add_keyframe(scan, track, found);
        }
    }
}

impl SubmapMatcher {
    pub(super) fn new(noise_m: f64) -> Self {
        Self { noise_m, sees_nothing: true, ..Self::default() }
    }

    /// Whether the robot has not left the place where it started.
    fn is_at_start(&self, pose: &Isometry2<f64>) -> bool {
        let from_start = |start: &Keyframe| start.local.inv_mul(pose).translation.vector.norm();
        self.keyframes.first().is_none_or(|start| from_start(start) < START_M)
    }

    /// The growing submaps as they are: there is no further reading.
    pub(super) fn end(&mut self) {
        let growing = self.growing.drain(..);
        self.finished.extend(growing.map(|submap| submap.finish(&self.keyframes)));
    }

    /// The pose relative to the last keyframe.
    pub(super) fn offset(&self, track: &Track) -> Isometry2<f64> {
        self.keyframes.last().map_or(Isometry2::identity(), |keyframe| keyframe.local.inv_mul(&track.pose))
    }

    /// Begins with a keyframe that shows nothing: the first reading is invalid.
    pub(super) fn begin_without_scan(&mut self, reading: &LaserReading, track: &Track) {
        self.push(reading, track, Vec::new(), (Isometry2::identity(), Matrix3::zeros()));
    }

    /// The match of a far scan; `None` if there is nothing to match with.
    fn match_far(&self, scan: &IncomingScan) -> Option<SubmapMatch> {
        let found = found_among(&self.keyframes, scan)?;
        let agreement = Agreement::of_response(found.response);
        Some(SubmapMatch { found: matched_at(&found.pose, &scan.points)?, agreement })
    }

    /// The match of the scan with the submap; `None` if there is nothing to match with.
    fn match_submap(&self, scan: &IncomingScan, track: &Track) -> Option<SubmapMatch> {
        let (map, points, pose) = (&self.growing.first()?.map, &scan.points, &track.pose);
        let matched_from = |start: &Isometry2<f64>, prior: &Prior, first_m: f64| {
            let gates = gates(self.noise_m, first_m);
            let found = align(map, points, start, Some(prior), &gates)?;
            let agreement = agreement(map, points, &found.placement, gates.last_m);
            (agreement.confirmed_points >= MIN_POINTS).then_some(SubmapMatch { found, agreement })
        };
        let at_range_m = 5.0 * track.covariance[(2, 2)].sqrt();
        let first_m = SURFEL_M + 2.0 * (scan.predicted.spread_m() + at_range_m);
        let matched = matched_from(pose, &scan.predicted.prior()?, first_m)?;
        if !matched.is_below(MIN_AGREEMENT, MAJORITY) {
            return Some(matched);
        }
        let wide = track.covariance + SEARCHED_STD.covariance();
        let wide = Prior { pose: *pose, information: wide.try_inverse()?, begin: None };
        // The best of a match and those from other poses.
        let better = |matched: SubmapMatch, starts: &[Isometry2<f64>]| {
            let min_confirmed = CLEARLY * matched.agreement.confirmed;
            let others = starts.iter().filter_map(|start| matched_from(start, &wide, JUDGED_M / 2.0));
            others
                .filter(|other| other.agreement.confirmed > min_confirmed)
                .max_by(|a, b| a.agreement.confirmed.total_cmp(&b.agreement.confirmed))
                .unwrap_or(matched)
        };
        let turns_rad = OTHER_TURNS_RAD.into_iter().flat_map(|turn_rad| [turn_rad, -turn_rad]);
        let turned: Vec<_> = turns_rad.map(|turn_rad| pose * interfaces::pose(0.0, 0.0, turn_rad)).collect();
        let matched = better(matched, &turned);
        if !matched.is_below(MAJORITY, MIN_SHARE) {
            return Some(matched);
        }
        let near = SurfelMap::of_points(&map.points(&Isometry2::identity()))?;
        let window = Window { pose: *pose, reach_m: SEARCHED.m, reach_rad: SEARCHED.rad };
        let grid = ScoreGrid::anywhere(&near);
        let found = search(&mut { MAX_WORK }, &grid, points, &window, (MIN_OVERLAP, CLEARLY.recip()));
        Some(better(matched, &found))
    }

    /// Makes the scan a keyframe.
    fn add_keyframe(&mut self, scan: &IncomingScan, track: &Track, found: Option<&Match>) {
        let from_last = self.keyframes.last().map_or((track.pose, Matrix3::zeros()), |last| {
            let motion = last.local.inv_mul(&track.pose);
            let odometry = Motion::new(self.since_keyframe);
            let by_odometry = match scan.has_odometry {
                true => {
                    odometry.propagate(&Isometry2::identity(), &Spread::of_motion(SCAN_STD.m).covariance())
                }
                false => MISSING_STD.covariance(),
            };
            let scan = found.map(|found| in_frame(&found.scan_information, &last.local));
            let spread = motion_spread(&motion, (&self.since_keyframe, &by_odometry), scan.as_ref());
            let information = (spread + KEYFRAME_STD.covariance()).try_inverse();
            (motion, information.unwrap_or_else(Matrix3::identity))
        });
        if let Some((found, last)) = found.zip(self.keyframes.last()).filter(|_| scan.has_odometry) {
            let information = in_frame(&found.scan_information, &last.local);
            let (to, motion) = (self.keyframes.len(), self.measured);
            self.measured_motions.push(MeasuredMotion { to, motion, information });
        }
        self.push(&scan.reading, track, filled(&scan.points), from_last);
    }

    fn push(
        &mut self,
        reading: &LaserReading,
        track: &Track,
        points: Vec<ScanPoint>,
        from_last: (Isometry2<f64>, Matrix3<f64>),
    ) {
        (self.since_keyframe, self.measured) = (Isometry2::identity(), Isometry2::identity());
        let (mount, scan) = (reading.mount, reading.scan.clone());
        self.keyframes.push(Keyframe { local: track.pose, from_last, points, mount, scan });
        self.grow();
    }

    /// Adds the last keyframe to the growing submaps.
    fn grow(&mut self) {
        let number = self.keyframes.len() - 1;
        let keyframe = &self.keyframes[number];
        let half = SUBMAP_KEYFRAMES / 2;
        if self.growing.last().is_none_or(|youngest| youngest.keyframes.len() >= half) {
            self.growing.extend(GrowingSubmap::new(&keyframe.local));
        }
        for submap in &mut self.growing {
            submap.add(number, keyframe, self.noise_m);
        }
        self.keyframes[number].points = thinned(&self.keyframes[number].points, KEPT_POINTS);
        if self.growing.len() > 1 && self.growing[0].keyframes.len() >= SUBMAP_KEYFRAMES {
            let full = self.growing.remove(0);
            self.finished.push_back(full.finish(&self.keyframes));
        }
    }
}

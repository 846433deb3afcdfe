//! From reading to reading: the pose by matching with the submap of the last keyframes.

use super::graph::{Edge, EdgeKind, PoseGraph};
use super::keyframe::{Keyframe, filled};
use super::matching::{WIDEST_M, covariance, gates, in_frame, motion_spread};
use super::settings::TrajectorySettings;
use super::submap::{Agreement, FinishedSubmap, GrowingSubmap, agreement};
use crate::calibration::Calibration;
use crate::estimate::PoseState;
use crate::faults::{Fault, FaultFinder};
use crate::matcher::{Match, Prior, align};
use crate::motion::{Motion, Predicted};
use crate::path::Path;
use crate::placement::shifted;
use crate::scan_points::ScanPoints;
use crate::score_grid::ScoreGrid;
use crate::search::{Window, search};
use crate::surfel_map::SurfelMap;
use crate::sweep::SweepUndo;
use interfaces::{LaserReading, heading_rad};
use nalgebra::{Isometry2, Matrix3};

/// An odometry that has moved by this is there, m and rad.
const LEAST_M: f64 = 0.005;
const LEAST_RAD: f64 = 0.005;
/// The uncertainty of a motion between keyframes without odometry, m and rad.
const MISSING_STD_M: f64 = 0.3;
const MISSING_STD_RAD: f64 = 0.3;
/// A pose counts as supported if at least this share of what the submap can judge agrees, and this many points.
const LEAST_AGREEMENT: f64 = 0.7;
const LEAST_POINTS: usize = 12;
/// The shares of agreeing points below which other headings are tried: of those that the submap can judge, and of all.
const DOUBTED_AGREEMENT: f64 = 0.75;
const DOUBTED_SHARE: f64 = 0.5;
/// These headings, rad. A robot that turns in place while its laser and its odometry are out of step is off by these.
const OTHER_HEADINGS_RAD: [f64; 6] = [0.08, -0.08, 0.16, -0.16, 0.25, -0.25];
/// The shares below which the pose is searched for around the prediction.
const SEARCH_AGREEMENT: f64 = 0.5;
const SEARCH_SHARE: f64 = 0.3;
const SEARCH_M: f64 = 0.8;
const SEARCH_RAD: f64 = 0.4;
const SEARCH_SCORE: f64 = 0.4;
/// What is added to the uncertainty of the prediction for other headings and for a search, m and rad. Along a corridor
/// nothing but the odometry says how far the robot went.
const WIDE_STD_M: f64 = 0.05;
const WIDE_STD_RAD: f64 = 0.3;
/// Another pose must confirm more than the prediction by this factor.
const BETTER: f64 = 1.15;
/// The errors of a matched motion that do not average out, m and rad.
const MODEL_STD_M: f64 = 0.004;
const MODEL_STD_RAD: f64 = 0.0015;

/// Matches scan by scan.
#[derive(Debug)]
pub(super) struct FrontEnd {
    settings: TrajectorySettings,
    faults: FaultFinder,
    calibration: Calibration,
    sweeps: SweepUndo,
    points: ScanPoints,
    /// The time of the last reading, s.
    time_s: Option<f64>,
    odometry: Option<Isometry2<f64>>,
    /// Whether the odometry has ever moved.
    has_odometry: bool,
    /// The last motion by matching.
    last_motion: Isometry2<f64>,
    /// The pose by matching with local submaps alone, and its covariance within the submap.
    pose: Isometry2<f64>,
    covariance: Matrix3<f64>,
    /// The motion by odometry since the last keyframe.
    since_keyframe: Isometry2<f64>,
    keyframes: Vec<Keyframe>,
    /// The older one is matched with, the younger one is only filled.
    growing: Vec<GrowingSubmap>,
    finished: Vec<FinishedSubmap>,
    /// The memory of the last submap that was finished.
    spare: Option<SurfelMap>,
}

/// The result of a match with a submap.
struct Tracked {
    found: Match,
    agreement: Agreement,
}

impl Tracked {
    /// Whether less of the scan agrees: of what the submap can judge, or of all.
    fn is_below(&self, agreement: f64, share: f64) -> bool {
        self.agreement.share() < agreement || self.agreement.confirmed < share * self.agreement.all
    }
}

impl FrontEnd {
    pub(super) fn new(settings: &TrajectorySettings) -> Self {
        Self {
            settings: settings.clone(),
            faults: FaultFinder::default(),
            calibration: Calibration::new(&settings.odometry),
            sweeps: SweepUndo::default(),
            points: ScanPoints::default(),
            time_s: None,
            odometry: None,
            has_odometry: false,
            last_motion: Isometry2::identity(),
            pose: Isometry2::identity(),
            covariance: Matrix3::zeros(),
            since_keyframe: Isometry2::identity(),
            keyframes: Vec::new(),
            growing: Vec::new(),
            finished: Vec::new(),
            spare: None,
        }
    }

    /// The odometry is there, though it may not have moved yet.
    pub(super) fn expect_odometry(&mut self) {
        self.has_odometry = true;
    }

    /// Whether the last scan shows no surface.
    pub(super) fn sees_nothing(&self) -> bool {
        self.points.points().is_empty()
    }

    pub(super) fn keyframes(&self) -> &[Keyframe] {
        &self.keyframes
    }

    /// The next submap that is full.
    pub(super) fn next_finished(&mut self) -> Option<FinishedSubmap> {
        if self.finished.is_empty() { None } else { Some(self.finished.remove(0)) }
    }

    /// The growing submaps as they are: there is no further reading.
    pub(super) fn end(&mut self) {
        let growing = self.growing.drain(..);
        self.finished.extend(growing.map(|submap| submap.finish(&self.keyframes).0));
    }

    /// The pose of a reading relative to the last keyframe of the graph, to which new keyframes are added.
    pub(super) fn localize(
        &mut self,
        reading: &LaserReading,
        graph: &mut PoseGraph,
    ) -> (Isometry2<f64>, PoseState) {
        let fault = self.faults.find(reading);
        if fault == Some(Fault::Invalid) {
            if graph.poses.is_empty() {
                self.points.clear();
                self.add_keyframe(graph, reading, None);
            }
            return (self.offset(), PoseState::Lost);
        }
        let before = self.odometry.replace(reading.pose).unwrap_or(reading.pose);
        let measured = before.inv_mul(&reading.pose);
        let motion = self.predict(&measured);
        self.since_keyframe *= motion.delta;
        self.since_keyframe.rotation.renormalize();
        let elapsed_s = reading.time_s - self.time_s.unwrap_or(reading.time_s);
        if fault.is_none() {
            self.time_s = Some(reading.time_s);
        }
        let last = self.pose;
        let predicted = motion.predict(&last, &self.covariance, reading.scan.sweep_s > 0.0);
        (self.pose, self.covariance) = (predicted.pose, predicted.covariance);
        if fault == Some(Fault::Frozen) && !graph.poses.is_empty() {
            return (self.offset(), PoseState::Uncertain);
        }
        let rules = self.settings.point_rules();
        let mut posed = reading.clone();
        // A log can begin while the robot moves: before its first scan, no pose is known.
        let in_sweep =
            if graph.poses.is_empty() { Path::by_velocities(reading) } else { (motion.delta, elapsed_s) };
        self.sweeps.update(&mut posed, &mut self.points, &rules, reading, (&in_sweep.0, in_sweep.1));
        let tracked = self.track(&predicted);
        if let Some(tracked) = &tracked {
            let begin = shifted(&last, &tracked.found.placement.begin());
            self.last_motion = begin.inv_mul(&tracked.found.placement.pose);
            self.pose = tracked.found.placement.pose;
            self.covariance =
                tracked.found.information.try_inverse().unwrap_or_else(|| covariance(0.1, 0.05))
                    + covariance(0.001, 3e-4);
        }
        // The first scan is right by definition.
        let is_supported = graph.poses.is_empty()
            || tracked.as_ref().is_some_and(|tracked| tracked.agreement.share() >= LEAST_AGREEMENT);
        if tracked.as_ref().is_some_and(|tracked| !tracked.is_below(DOUBTED_AGREEMENT, DOUBTED_SHARE)) {
            self.calibration.learn(&measured, &self.last_motion);
            if reading.scan.sweep_s > 0.0 {
                // The noise of the odometry within a scan bends its walls. The motion that the match has found does not.
                let found = (&self.last_motion, elapsed_s);
                self.sweeps.update(&mut posed, &mut self.points, &rules, reading, found);
            }
        }
        let offset = self.offset();
        let is_far = offset.translation.vector.norm() >= self.settings.keyframe_m
            || heading_rad(&offset).abs() >= self.settings.keyframe_rad;
        if graph.poses.is_empty() || is_far {
            self.add_keyframe(graph, &posed, tracked.as_ref().map(|tracked| &tracked.found));
        }
        (self.offset(), if is_supported { PoseState::Tracking } else { PoseState::Uncertain })
    }

    /// The motion by odometry. Until the odometry moves for the first time, it may be missing: then the robot goes on as
    /// before.
    fn predict(&mut self, measured: &Isometry2<f64>) -> Motion {
        let turn_rad = heading_rad(measured).abs();
        self.has_odometry |= measured.translation.vector.norm() > LEAST_M || turn_rad > LEAST_RAD;
        if self.has_odometry {
            Motion::new(self.calibration.correct(measured), &self.settings.odometry)
        } else {
            Motion::new(self.last_motion, &self.settings.odometry).distrusted()
        }
    }

    /// The pose relative to the last keyframe.
    fn offset(&self) -> Isometry2<f64> {
        self.keyframes.last().map_or(Isometry2::identity(), |keyframe| keyframe.local.inv_mul(&self.pose))
    }

    /// The match of the scan with the submap; `None` if there is nothing to match with.
    fn track(&self, predicted: &Predicted) -> Option<Tracked> {
        let map = self.growing.first()?.map();
        let prior = predicted.prior()?;
        let spread_m = (self.covariance[(0, 0)] + self.covariance[(1, 1)]).sqrt();
        let at_range_m = 5.0 * self.covariance[(2, 2)].sqrt();
        let tracked = self.matched(map, &self.pose, &prior, 0.1 + 2.0 * (spread_m + at_range_m))?;
        if !tracked.is_below(DOUBTED_AGREEMENT, DOUBTED_SHARE) {
            return Some(tracked);
        }
        let wide = self.covariance + covariance(WIDE_STD_M, WIDE_STD_RAD);
        let wide = Prior { pose: self.pose, information: wide.try_inverse()?, begin: None };
        let turned = OTHER_HEADINGS_RAD.map(|turn_rad| self.pose * interfaces::pose(0.0, 0.0, turn_rad));
        let tracked = self.better(map, tracked, &turned, &wide);
        if !tracked.is_below(SEARCH_AGREEMENT, SEARCH_SHARE) {
            return Some(tracked);
        }
        let near = SurfelMap::of_points(&map.points(&Isometry2::identity()))?;
        let window = Window { pose: self.pose, reach_m: SEARCH_M, reach_rad: SEARCH_RAD };
        let grid = ScoreGrid::anywhere(&near);
        let found = search(&grid, self.points.points(), Some(&window), SEARCH_SCORE, BETTER.recip());
        let found: Vec<Isometry2<f64>> = found.iter().map(|candidate| candidate.pose).collect();
        Some(self.better(map, tracked, &found, &wide))
    }

    /// The best of a match and those from other poses.
    fn better(&self, map: &SurfelMap, tracked: Tracked, starts: &[Isometry2<f64>], prior: &Prior) -> Tracked {
        let least = BETTER * tracked.agreement.confirmed;
        let others = starts.iter().filter_map(|start| self.matched(map, start, prior, WIDEST_M / 2.0));
        others
            .filter(|other| other.agreement.confirmed > least)
            .max_by(|a, b| a.agreement.confirmed.total_cmp(&b.agreement.confirmed))
            .unwrap_or(tracked)
    }

    fn matched(
        &self,
        map: &SurfelMap,
        start: &Isometry2<f64>,
        prior: &Prior,
        first_m: f64,
    ) -> Option<Tracked> {
        let points = self.points.points();
        let gates = gates(self.settings.range_noise_std_m, first_m);
        let found = align(map, points, start, Some(prior), &gates)?;
        let agreement = agreement(map, points, &found.placement, gates.last_m);
        (agreement.confirmed_points >= LEAST_POINTS).then_some(Tracked { found, agreement })
    }

    /// Makes the scan a keyframe.
    fn add_keyframe(&mut self, graph: &mut PoseGraph, reading: &LaserReading, found: Option<&Match>) {
        if let (Some(last), Some(at)) = (self.keyframes.last(), graph.poses.last().copied()) {
            let motion = last.local.inv_mul(&self.pose);
            let odometry = Motion::new(self.since_keyframe, &self.settings.odometry);
            let by_odometry = match self.has_odometry {
                true => odometry.propagate(&Isometry2::identity(), &covariance(1e-3, 1e-3)),
                false => covariance(MISSING_STD_M, MISSING_STD_RAD),
            };
            let scan = found.map(|found| in_frame(&found.scan_information, &last.local));
            let (from, to) = (graph.poses.len() - 1, graph.poses.len());
            let spread = motion_spread(&motion, (&self.since_keyframe, &by_odometry), scan.as_ref());
            let information = (spread + covariance(MODEL_STD_M, MODEL_STD_RAD)).try_inverse();
            let information = information.unwrap_or_else(Matrix3::identity);
            graph.edges.push(Edge { from, to, motion, information, kind: EdgeKind::Match });
            let mut pose = at * motion;
            pose.rotation.renormalize();
            graph.poses.push(pose);
        } else {
            graph.poses.push(self.pose);
        }
        self.since_keyframe = Isometry2::identity();
        self.keyframes.push(Keyframe {
            local: self.pose,
            points: filled(self.points.points()),
            mount: reading.mount,
            scan: reading.scan.clone(),
        });
        self.grow();
    }

    /// Adds the last keyframe to the growing submaps.
    fn grow(&mut self) {
        let number = self.keyframes.len() - 1;
        let keyframe = &self.keyframes[number];
        let half = self.settings.submap_keyframes / 2;
        if self.growing.last().is_none_or(|youngest| youngest.len() >= half) {
            self.growing.extend(GrowingSubmap::new(&keyframe.local, self.spare.take()));
        }
        for submap in &mut self.growing {
            submap.add(number, keyframe, self.settings.range_noise_std_m);
        }
        self.keyframes[number].thin();
        if self.growing.len() > 1 && self.growing[0].len() >= self.settings.submap_keyframes {
            let full = self.growing.remove(0);
            let (finished, spare) = full.finish(&self.keyframes);
            self.finished.push(finished);
            self.spare = Some(spare);
        }
    }
}

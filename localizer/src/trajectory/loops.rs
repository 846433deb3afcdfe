//! Loops: a finished submap is searched for in earlier submaps.

use super::free_space::passing_share;
use super::front_end::{covariance, gates};
use super::graph::{Edge, EdgeKind, PoseGraph};
use super::keyframe::Keyframe;
use super::odometry_drift::{reach, ways_m};
use super::settings::TrajectorySettings;
use super::submap::{Agreement, FinishedSubmap, agreement};
use crate::matcher::{Match, Prior, align};
use crate::scan_points::ScanPoint;
use crate::score_grid::ScoreGrid;
use crate::search::{Window, search};
use crate::surfel_map::SurfelMap;
use interfaces::heading_rad;
use nalgebra::{Isometry2, Matrix3, Vector3};

/// Submaps that are connected by a shorter way need no loop, m.
const LEAST_WAY_M: f64 = 8.0;
/// Two submaps may cover the same place if their middles are this near, beyond the uncertainty, m.
const NEAR_M: f64 = 6.0;
/// The number of earlier submaps in which a submap is searched for.
const MOST_SEARCHES: usize = 3;
/// Points of a submap farther from its middle than this are not searched for, m: they may lie outside of the other.
const COMPARED_M: f64 = 10.0;
/// The number of points that are compared.
const MOST_POINTS: usize = 300;
/// The least score of a pose in a search, and the share of the best score that other poses are examined with.
const LEAST_SCORE: f64 = 0.35;
const EXAMINED: f64 = 0.75;
/// The least shares of a loop: of the points that the other submap can judge, and of those that agree.
const LEAST_OVERLAP: f64 = 0.45;
const LEAST_AGREEMENT: f64 = 0.8;
/// The same of a loop that is accepted although the trajectory ends before another submap can confirm it.
const STRONG_OVERLAP: f64 = 0.5;
const STRONG_AGREEMENT: f64 = 0.88;
const STRONG_PASSING: f64 = 0.03;
/// The largest share of beams that pass surfaces of the other submap.
const MOST_PASSING: f64 = 0.06;
/// A loop is ambiguous if another pose confirms at least this share of what it confirms.
const AMBIGUOUS: f64 = 0.9;
/// Poses nearer than this are the same, m and rad.
const SAME_M: f64 = 0.25;
const SAME_RAD: f64 = 0.08;
/// After a way shorter than this, a loop needs no other that agrees, m.
const SHORT_WAY_M: f64 = 20.0;
/// Two loops that agree begin and end at most this many submaps apart, and differ by no more than the trajectory between
/// them is uncertain.
const NEIGHBORS: usize = 6;
/// The way from keyframe to keyframe, for this uncertainty, m.
const KEYFRAME_M: f64 = 0.35;
/// The errors of a relative pose of submaps that do not average out, m and rad.
const MODEL_STD_M: f64 = 0.02;
const MODEL_STD_RAD: f64 = 0.004;
/// The share of the information about a position that may come from normals that are a little off.
const SPURIOUS_SHARE: f64 = 0.03;
/// The uncertainty of a direction that no surface fixes, m and rad.
const LOOSE_M: f64 = 10.0;
const LOOSE_RAD: f64 = 1.0;
/// The graph is optimised at once if a new loop contradicts it by this, m and rad.
const URGENT_M: f64 = 0.1;
const URGENT_RAD: f64 = 0.03;
/// The number of score grids that are kept.
const MOST_GRIDS: usize = 6;

/// A recognised place: the pose of submap `to` in submap `from`.
#[derive(Clone, Debug)]
struct Loop {
    from: usize,
    to: usize,
    edge: Edge,
    /// Whether little speaks against it.
    is_strong: bool,
}

/// Finds loops and adds them to the graph.
#[derive(Debug)]
pub(super) struct LoopCloser {
    noise_m: f64,
    submaps: Vec<FinishedSubmap>,
    /// Loops that no other loop has confirmed yet.
    pending: Vec<Loop>,
    accepted: Vec<Loop>,
    /// The maps and scores of the submaps that were searched last.
    grids: Vec<(usize, SurfelMap, ScoreGrid)>,
}

impl LoopCloser {
    pub(super) fn new(settings: &TrajectorySettings) -> Self {
        Self {
            noise_m: settings.range_noise_std_m,
            submaps: Vec::new(),
            pending: Vec::new(),
            accepted: Vec::new(),
            grids: Vec::new(),
        }
    }

    pub(super) fn submaps(&self) -> &[FinishedSubmap] {
        &self.submaps
    }

    pub(super) fn noise_m(&self) -> f64 {
        self.noise_m
    }

    /// The number of loops that were accepted.
    pub(super) fn loops(&self) -> usize {
        self.accepted.len()
    }

    /// Searches for a finished submap in the earlier ones.
    pub(super) fn add(&mut self, submap: FinishedSubmap, keyframes: &[Keyframe], graph: &mut PoseGraph) {
        let to = self.submaps.len();
        self.submaps.push(submap);
        let mut is_urgent = false;
        for (from, way_m) in self.candidates(to, graph) {
            let Some(found) = self.search_in(from, to, way_m, keyframes, graph) else { continue };
            if way_m <= SHORT_WAY_M || self.is_confirmed(&found, graph) {
                is_urgent |= is_urgent_in(&found.edge, graph);
                self.accept(found, graph);
            } else {
                self.pending.push(found);
            }
        }
        if is_urgent {
            graph.optimize();
        }
    }

    /// Optimises the graph with all loops. Of those that wait for others, strong ones are accepted if two earlier submaps
    /// say the same.
    pub(super) fn finish(&mut self, graph: &mut PoseGraph) {
        let pending = std::mem::take(&mut self.pending);
        for found in pending.iter().filter(|found| found.is_strong) {
            let mut others = pending.iter().filter(|other| other.from != found.from && other.to == found.to);
            if others.any(|other| agree(found, other, graph)) {
                self.accept(found.clone(), graph);
            }
        }
        graph.optimize();
        graph.remove_outliers();
        graph.optimize();
    }

    /// The earlier submaps that may cover the place of a submap, and the ways to them, m: the nearest ones.
    fn candidates(&self, to: usize, graph: &PoseGraph) -> Vec<(usize, f64)> {
        let submap = &self.submaps[to];
        let ways_m = ways_m(graph, submap.anchor);
        let distance_m = |other: &FinishedSubmap| {
            graph.poses[other.anchor].inv_mul(&graph.poses[submap.anchor]).translation.vector.norm()
        };
        let earlier = self.submaps[..to].iter().enumerate().filter(|(_, other)| other.last < submap.first);
        let mut candidates: Vec<(usize, f64, f64)> = earlier
            .map(|(from, other)| (from, ways_m[other.anchor], distance_m(other)))
            .filter(|(_, way_m, distance_m)| {
                *way_m >= LEAST_WAY_M && *distance_m <= NEAR_M + reach(*way_m).0
            })
            .collect();
        candidates.sort_by(|a, b| a.2.total_cmp(&b.2));
        let mut chosen: Vec<(usize, f64)> = Vec::new();
        for (from, way_m, _) in candidates {
            // Neighbors share half of their keyframes.
            if chosen.len() < MOST_SEARCHES && chosen.iter().all(|(other, _)| from.abs_diff(*other) > 1) {
                chosen.push((from, way_m));
            }
        }
        chosen
    }

    /// The pose of a submap in an earlier one, if there is one, and no other fits about as well.
    fn search_in(
        &mut self,
        from: usize,
        to: usize,
        way_m: f64,
        keyframes: &[Keyframe],
        graph: &PoseGraph,
    ) -> Option<Loop> {
        self.prepare(from)?;
        let (_, map, grid) = self.grids.iter().find(|(number, ..)| *number == from)?;
        let (anchor, other) = (self.submaps[from].anchor, self.submaps[to].anchor);
        let pose = graph.poses[anchor].inv_mul(&graph.poses[other]);
        let (reach_m, reach_rad) = reach(way_m);
        let is_near = |point: &&ScanPoint| point.at.coords.norm() <= COMPARED_M;
        let near: Vec<ScanPoint> = self.submaps[to].points.iter().filter(is_near).copied().collect();
        let points = thinned(&near, MOST_POINTS);
        let window = Window { pose, reach_m, reach_rad };
        let candidates = search(grid, &points, Some(&window), LEAST_SCORE, EXAMINED);
        let mut fits: Vec<(Match, Agreement)> = candidates
            .iter()
            .filter_map(|candidate| fit(map, &points, &candidate.pose, (0.3, 0.05), self.noise_m))
            .collect();
        fits.sort_by(|a, b| b.1.confirmed.total_cmp(&a.1.confirmed));
        let (best, agreement) = fits.first()?;
        let is_rival = |(fit, agreement): &&(Match, Agreement), least: f64| {
            let between = best.pose.inv_mul(&fit.pose);
            let is_same = between.translation.vector.norm() < SAME_M && heading_rad(&between).abs() < SAME_RAD;
            !is_same && agreement.confirmed >= least
        };
        let is_ambiguous = fits.iter().any(|fit| is_rival(&fit, AMBIGUOUS * agreement.confirmed));
        let passing = passing_share(&self.submaps[from], &self.submaps[to], &best.pose, keyframes);
        if std::env::var("LOOPS").is_ok() {
            eprintln!(
                "{from} {to} way {way_m:.1} reach {reach_m:.1} {reach_rad:.2} found {} overlap {:.2} agree {:.2} passing {passing:.3} ambiguous {is_ambiguous} off {:.2} {:.3}",
                candidates.len(),
                agreement.overlap(),
                agreement.share(),
                pose.inv_mul(&best.pose).translation.vector.norm(),
                heading_rad(&pose.inv_mul(&best.pose))
            );
        }
        if is_ambiguous || passing > MOST_PASSING || agreement.overlap() < LEAST_OVERLAP || agreement.share() < LEAST_AGREEMENT {
            return None;
        }
        let information = loop_information(best, MODEL_STD_M, MODEL_STD_RAD)?;
        let edge = Edge { from: anchor, to: other, motion: best.pose, information, kind: EdgeKind::Loop };
        let is_strong = agreement.overlap() >= STRONG_OVERLAP
            && agreement.share() >= STRONG_AGREEMENT
            && passing <= STRONG_PASSING;
        Some(Loop { from, to, edge, is_strong })
    }

    /// Makes the scores of a submap.
    fn prepare(&mut self, number: usize) -> Option<()> {
        if self.grids.iter().all(|(known, ..)| *known != number) {
            let map = SurfelMap::of_points(&self.submaps[number].points)?;
            let grid = ScoreGrid::anywhere(&map);
            if self.grids.len() == MOST_GRIDS {
                self.grids.remove(0);
            }
            self.grids.push((number, map, grid));
        }
        Some(())
    }

    /// Whether other loops between the same parts of the trajectory agree: at least one more than contradict. Loops
    /// that wait for this are accepted with it.
    fn is_confirmed(&mut self, found: &Loop, graph: &mut PoseGraph) -> bool {
        let (mut agreeing, mut contradicting) = (0, 0);
        for other in self.pending.iter().chain(&self.accepted).filter(|other| are_neighbors(found, other)) {
            match agree(found, other, graph) {
                true => agreeing += 1,
                false => contradicting += 1,
            }
        }
        let is_confirmed = agreeing > contradicting;
        if is_confirmed {
            let (confirmed, pending): (Vec<Loop>, Vec<Loop>) = std::mem::take(&mut self.pending)
                .into_iter()
                .partition(|other| are_neighbors(found, other) && agree(found, other, graph));
            self.pending = pending;
            for other in confirmed {
                self.accept(other, graph);
            }
        }
        is_confirmed
    }

    fn accept(&mut self, found: Loop, graph: &mut PoseGraph) {
        graph.edges.push(found.edge.clone());
        self.accepted.push(found);
    }
}

/// Whether two loops connect the same parts of the trajectory, and were not found with the same submap.
fn are_neighbors(a: &Loop, b: &Loop) -> bool {
    a.from.abs_diff(b.from) <= NEIGHBORS && a.to.abs_diff(b.to) <= NEIGHBORS && a.to != b.to
}

/// Whether two loops say the same.
fn agree(a: &Loop, b: &Loop, graph: &PoseGraph) -> bool {
    let between = |from: usize, to: usize| graph.poses[from].inv_mul(&graph.poses[to]);
    let expected = between(a.edge.from, b.edge.from) * b.edge.motion * between(b.edge.to, a.edge.to);
    let off = expected.inv_mul(&a.edge.motion);
    let keyframes = a.edge.from.abs_diff(b.edge.from) + a.edge.to.abs_diff(b.edge.to);
    let (most_m, most_rad) = reach(keyframes as f64 * KEYFRAME_M);
    off.translation.vector.norm() <= most_m && heading_rad(&off).abs() <= most_rad
}

/// Whether a loop contradicts the trajectory so much that all later searches profit from it.
fn is_urgent_in(edge: &Edge, graph: &PoseGraph) -> bool {
    let off = edge.motion.inv_mul(&graph.poses[edge.from].inv_mul(&graph.poses[edge.to]));
    off.translation.vector.norm() > URGENT_M || heading_rad(&off).abs() > URGENT_RAD
}

/// At most a number of points, evenly taken.
pub(super) fn thinned(points: &[ScanPoint], most: usize) -> Vec<ScanPoint> {
    points.iter().step_by(points.len().div_ceil(most).max(1)).copied().collect()
}

/// Matches points with a map, from a pose that is uncertain by this much (m, rad).
pub(super) fn fit(
    map: &SurfelMap,
    points: &[ScanPoint],
    pose: &Isometry2<f64>,
    (std_m, std_rad): (f64, f64),
    noise_m: f64,
) -> Option<(Match, Agreement)> {
    let prior = Prior { pose: *pose, information: covariance(std_m, std_rad).try_inverse()? };
    let gates = gates(noise_m, std_m);
    let found = align(map, points, pose, Some(&prior), &gates)?;
    let agreement = agreement(map, points, &found.pose, gates.last_m);
    Some((found, agreement))
}

/// The information of a match, with the errors of the model (m, rad). Directions that the scan does not fix stay free:
/// of all that a scan says, a small share comes from normals that are a little off.
pub(super) fn loop_information(found: &Match, std_m: f64, std_rad: f64) -> Option<Matrix3<f64>> {
    let scan = &found.scan_information;
    let off = SPURIOUS_SHARE * (scan[(0, 0)] + scan[(1, 1)]);
    let eigen = (scan - Matrix3::from_diagonal(&Vector3::new(off, off, 0.0))).symmetric_eigen();
    let values = eigen.eigenvalues.map(|value| value.max(0.0));
    let fixed = eigen.eigenvectors * Matrix3::from_diagonal(&values) * eigen.eigenvectors.transpose();
    let free = covariance(LOOSE_M, LOOSE_RAD).try_inverse()?;
    let spread = (fixed + free).try_inverse()? * found.residual_ratio.max(1.0);
    (spread + covariance(std_m, std_rad)).try_inverse()
}

//! The trajectory of a robot from a whole log, with loops: offline, and without a known extent of the place.
//!
//! ```text
//! reading ─▶ match with the local submap ─▶ keyframe ─▶ submap is finished ─▶ loops? ─▶ pose graph ─▶ refine
//! ```
//!
//! - A scan is matched with the submap of the last keyframes only: an error of the past bends nothing that follows. A
//!   scan is deskewed along the motion that its match finds.
//! - A scan that is far from the one before is searched for around the prediction among the end points of the last
//!   keyframes (Olson 2009), and where it fits nowhere, at all headings. Its points are too few for the normals and the
//!   nearest optimum that a match with the submap needs, and the odometry learns only from matches with a high response (`constants::MIN_AGREEMENT`).
//! - A finished submap is searched for in earlier submaps by branch and bound, as far as the trajectory since then is
//!   uncertain (Hess, Kohler, Rapp & Andor 2016).
//! - A loop counts where most of what both submaps cover agrees, where few beams of one pass the walls of the other
//!   (`constants::MAX_PASSING`), where no other pose fits about as well, and where another loop agrees with it, unless the
//!   way since then was short.
//! - In the end, keyframes are matched with all submaps around them, so that every wall is there once; keyframes that are far from
//!   each other are correlated with the chains of earlier keyframes around them as well.

mod chains;
mod correlation;
mod distance_scale;
mod free_space;
mod graph;
mod known_place;
mod online;
mod places;
mod refine;
mod score_kernel;
mod sparse;
mod submap;
mod submap_matcher;

pub use distance_scale::DistanceScale;
pub use known_place::{KnownPlace, PlaceError, RouteSearch};
pub(crate) use submap::in_frame;
pub(crate) use submap_matcher::SubmapMatcher;

use crate::constants::{FOUND_STD, KEYFRAME_WAY_M, NEIGHBORS, SHORT_WAY_M};
use crate::estimate::PoseState;
use crate::local_trajectory_builder::LocalTrajectoryBuilder;
use crate::scan_points::PointRules;
use crate::settings::LocalizerSettings;
use graph::{Edge, PoseGraph, reach};
use interfaces::{LaserReading, SettingsError, heading_rad};
use nalgebra::Isometry2;
use places::{Places, RecognizedPlace};
use submap::{FinishedSubmap, Keyframe};

/// The pose of one reading.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct TrajectoryPose {
    /// The time of the reading, s.
    #[serde(with = "interfaces::serde_time")]
    pub time_s: f64,
    /// The pose of the robot, m and rad. The pose of the first reading is the origin.
    #[serde(with = "interfaces::serde_pose")]
    pub pose: Isometry2<f64>,
    /// [`PoseState::Tracking`] where the scan supports the pose, [`PoseState::Lost`] for invalid readings.
    pub state: PoseState,
}

/// A trajectory.
#[derive(Clone, Debug, Default)]
pub struct Trajectory {
    /// One pose per reading, in their order.
    pub poses: Vec<TrajectoryPose>,
    /// The number of places that were recognized.
    pub loops: usize,
    /// The distance from the surfaces that were seen in other passes, below which 97 % of the points of scans lie, m: the errors
    /// of ranges and poses together. `None` if no place was seen twice.
    pub residual_m: Option<f64>,
    /// The scale of the distances of the odometry; `None` where too few scans fix them.
    pub distance_scale: Option<DistanceScale>,
}

/// A reading, and its pose relative to a keyframe.
#[derive(Clone, Copy, Debug)]
struct Attached {
    time_s: f64,
    keyframe: usize,
    offset: Isometry2<f64>,
    state: PoseState,
}

/// Finds the trajectory of a robot from its readings, one after the other. The same readings give the same bits.
#[derive(Debug)]
pub struct TrajectoryFinder {
    pub(crate) builder: LocalTrajectoryBuilder<SubmapMatcher>,
    closer: LoopCloser,
    graph: PoseGraph,
    readings: Vec<Attached>,
}

impl TrajectoryFinder {
    /// A finder without a reading; see [`LocalizerSettings::of_logs`].
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn new(settings: &LocalizerSettings) -> Result<Self, SettingsError> {
        settings.check()?;
        Ok(Self {
            builder: LocalTrajectoryBuilder::new(
                SubmapMatcher::new(settings.range_noise_std_m),
                PointRules { noise_m: settings.range_noise_std_m, grazing: false },
            ),
            closer: LoopCloser::new(settings.range_noise_std_m),
            graph: PoseGraph::default(),
            readings: Vec::new(),
        })
    }

    /// The same finder, for an odometry whose distances are known to have a scale.
    #[must_use]
    pub fn with_distance_scale(mut self, scale: &DistanceScale) -> Self {
        self.builder.motion_prior.calibration.distance = (scale.scale, scale.std * scale.std);
        self
    }

    /// Adds the next reading. An invalid reading gets the pose of the odometry. Returns the reading as the laser would have measured it
    /// at once, at the end of the sweep.
    pub fn add(&mut self, reading: LaserReading) -> LaserReading {
        let time_s = reading.time_s;
        let (deskewed, state) = match self.builder.add(&reading, ()) {
            Some((deskewed, found)) if found.is_supported => (deskewed, PoseState::Tracking),
            Some((deskewed, _)) => (deskewed, PoseState::Uncertain),
            None => {
                if self.keyframes().is_empty() {
                    self.builder.matcher.begin_without_scan(&reading, &self.builder.track);
                }
                (reading, PoseState::Lost)
            }
        };
        self.add_keyframes();
        let keyframe = self.graph.poses.len() - 1;
        let offset = self.builder.matcher.offset(&self.builder.track);
        self.readings.push(Attached { time_s, keyframe, offset, state });
        self.search_loops();
        deskewed
    }

    /// Adds new keyframes to the graph.
    fn add_keyframes(&mut self) {
        let PoseGraph { poses, edges } = &mut self.graph;
        for keyframe in &self.builder.matcher.keyframes[poses.len()..] {
            let (motion, information) = keyframe.from_last;
            let Some(last) = poses.last() else {
                poses.push(keyframe.local);
                continue;
            };
            let mut pose = last * motion;
            pose.rotation.renormalize();
            let (from, to) = (poses.len() - 1, poses.len());
            edges.push(Edge { from, to, motion, information, is_loop: false });
            poses.push(pose);
        }
    }

    /// The pose of the last reading by matching with local submaps alone: without loops.
    pub fn local_pose(&self) -> Isometry2<f64> {
        self.builder.track.pose
    }

    fn keyframes(&self) -> &[Keyframe] {
        &self.builder.matcher.keyframes
    }

    /// Searches for the submaps that were finished since the last search.
    fn search_loops(&mut self) {
        while let Some(submap) = self.builder.matcher.finished.pop_front() {
            self.closer.add(submap, &self.builder.matcher.keyframes, &mut self.graph);
        }
    }

    /// The trajectory of all readings.
    pub fn finish(mut self) -> Trajectory {
        self.builder.matcher.end();
        self.search_loops();
        self.closer.accept_strong(&mut self.graph);
        self.graph = self.optimized();
        let residual_m = refine::residual_m(&self.closer.places, self.keyframes(), &self.graph);
        let loops = self.closer.accepted.len();
        let distance_scale =
            distance_scale::distance_scale(&self.builder.matcher.measured_motions, &self.graph);
        Trajectory { poses: self.poses(&self.graph), loops, residual_m, distance_scale }
    }

    /// The graph with all loops, where every wall is there once.
    fn optimized(&self) -> PoseGraph {
        let mut graph = self.graph.clone();
        graph.optimize();
        graph.remove_outliers();
        graph.optimize();
        if chains::are_sparse(self.keyframes()) {
            chains::correlate(self.keyframes(), &mut graph);
        }
        refine::refine(&self.closer.places, self.keyframes(), &mut graph);
        graph
    }

    /// The poses of all readings, where the keyframes have the poses of `graph`.
    fn poses(&self, graph: &PoseGraph) -> Vec<TrajectoryPose> {
        let pose = |reading: &Attached| TrajectoryPose {
            time_s: reading.time_s,
            pose: graph.poses[reading.keyframe] * reading.offset,
            state: reading.state,
        };
        self.readings.iter().map(pose).collect()
    }
}

// Loops: recognized places that other recognized places confirm.

/// Finds loops and adds them to the graph.
#[derive(Debug)]
struct LoopCloser {
    places: Places,
    /// Places that no other has confirmed yet.
    pending: Vec<RecognizedPlace>,
    /// In the order in which they were accepted.
    accepted: Vec<RecognizedPlace>,
}

impl LoopCloser {
    fn new(noise_m: f64) -> Self {
        Self { places: Places::new(noise_m), pending: Vec::new(), accepted: Vec::new() }
    }

    /// Searches for a finished submap in the earlier ones.
    fn add(&mut self, submap: FinishedSubmap, keyframes: &[Keyframe], graph: &mut PoseGraph) {
        let to = self.places.add(submap, graph);
        let mut is_urgent = false;
        for place in self.places.of(to, keyframes, graph) {
            if place.way_m <= SHORT_WAY_M || self.is_confirmed(&place, graph) {
                is_urgent |= is_urgent_in(&place.edge, graph);
                self.accept(place, graph);
            } else {
                self.pending.push(place);
            }
        }
        if is_urgent {
            graph.optimize();
        }
    }

    /// At the end: of the places that wait for others, strong ones are accepted if two earlier submaps say the same.
    fn accept_strong(&mut self, graph: &mut PoseGraph) {
        let pending = std::mem::take(&mut self.pending);
        for found in pending.iter().filter(|found| found.is_strong) {
            let mut others = pending.iter().filter(|other| other.from != found.from && other.to == found.to);
            if others.any(|other| agree(found, other, graph)) {
                self.accept(found.clone(), graph);
            }
        }
    }

    /// Whether other places between the same parts of the trajectory agree: at least one more than contradict. Places
    /// that wait for this are accepted with it.
    fn is_confirmed(&mut self, found: &RecognizedPlace, graph: &mut PoseGraph) -> bool {
        let (mut agreeing, mut contradicting) = (0, 0);
        for other in self.pending.iter().chain(&self.accepted).filter(|other| are_neighbors(found, other)) {
            match agree(found, other, graph) {
                true => agreeing += 1,
                false => contradicting += 1,
            }
        }
        let is_confirmed = agreeing > contradicting;
        if is_confirmed {
            let agrees =
                |other: &mut RecognizedPlace| are_neighbors(found, other) && agree(found, other, graph);
            let confirmed: Vec<RecognizedPlace> = self.pending.extract_if(.., agrees).collect();
            confirmed.into_iter().for_each(|other| self.accept(other, graph));
        }
        is_confirmed
    }

    fn accept(&mut self, found: RecognizedPlace, graph: &mut PoseGraph) {
        graph.edges.push(found.edge.clone());
        self.accepted.push(found);
    }
}

/// Whether two places connect the same parts of the trajectory, and were not found with the same submap.
fn are_neighbors(a: &RecognizedPlace, b: &RecognizedPlace) -> bool {
    a.from.abs_diff(b.from) <= NEIGHBORS && a.to.abs_diff(b.to) <= NEIGHBORS && a.to != b.to
}

/// Whether two places say the same.
fn agree(a: &RecognizedPlace, b: &RecognizedPlace, graph: &PoseGraph) -> bool {
    let between = |from: usize, to: usize| graph.poses[from].inv_mul(&graph.poses[to]);
    let expected = between(a.edge.from, b.edge.from) * b.edge.motion * between(b.edge.to, a.edge.to);
    let off = expected.inv_mul(&a.edge.motion);
    let keyframes = a.edge.from.abs_diff(b.edge.from) + a.edge.to.abs_diff(b.edge.to);
    let (max_m, max_rad) = reach(keyframes as f64 * KEYFRAME_WAY_M);
    off.translation.vector.norm() <= max_m && heading_rad(&off).abs() <= max_rad
}

/// Whether a loop contradicts the trajectory so much that all later searches profit from it.
fn is_urgent_in(edge: &Edge, graph: &PoseGraph) -> bool {
    let off = edge.motion.inv_mul(&graph.poses[edge.from].inv_mul(&graph.poses[edge.to]));
    !FOUND_STD.contains(&off)
}

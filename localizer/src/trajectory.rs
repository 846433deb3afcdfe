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
mod keyframe;
mod known_place;
mod loops;
mod matching;
mod online;
mod places;
mod refine;
mod score_kernel;
mod sparse;
mod submap;
mod submap_matcher;

pub use distance_scale::DistanceScale;
pub use known_place::{KnownPlace, PlaceError, RouteSearch};
pub(crate) use matching::in_frame;
pub(crate) use submap_matcher::SubmapMatcher;

use crate::estimate::PoseState;
use crate::local_trajectory_builder::LocalTrajectoryBuilder;
use crate::scan_points::PointRules;
use crate::settings::LocalizerSettings;
use graph::{Edge, PoseGraph};
use interfaces::{LaserReading, SettingsError};
use keyframe::Keyframe;
use loops::LoopCloser;
use nalgebra::Isometry2;

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
        self.builder.motion_prior.calibration.expect_distance(scale.scale, scale.std);
        self
    }

    /// Adds the next reading. An invalid reading gets the pose of the odometry.
    pub fn add(&mut self, reading: LaserReading) {
        let state = match self.builder.add(&reading, ()) {
            Some((_, found)) if found.is_supported => PoseState::Tracking,
            Some(_) => PoseState::Uncertain,
            None => {
                if self.keyframes().is_empty() {
                    self.builder.matcher.begin_without_scan(&reading, &self.builder.track);
                }
                PoseState::Lost
            }
        };
        self.add_keyframes();
        let (keyframe, time_s) = (self.graph.poses.len() - 1, reading.time_s);
        let offset = self.builder.matcher.offset(&self.builder.track);
        self.readings.push(Attached { time_s, keyframe, offset, state });
        self.search_loops();
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

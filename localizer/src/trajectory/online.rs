//! What is known about the trajectory while the robot still drives.

use super::TrajectoryFinder;
use super::graph::Edge;
use super::places::RecognizedPlace;
use super::submap::{fit, in_frame};
use crate::constants::{FOUND_STD, TURN_M};
use crate::estimate::PoseState;
use crate::surfel_map::SurfelMap;
use interfaces::heading_rad;
use nalgebra::{Isometry2, Matrix3};

/// New ground is farther than this from all places before, m.
const NEW_GROUND_M: f64 = 4.0;

impl TrajectoryFinder {
    /// The poses of all readings so far, with all loops that are closed. The pose of the first reading is the origin.
    pub(crate) fn corrected(&self) -> Vec<Isometry2<f64>> {
        self.poses(&self.optimized()).iter().map(|found| found.pose).collect()
    }

    /// The pose of the last reading, before the loops that are found later; `None` before the first one.
    pub fn newest(&self) -> Option<super::TrajectoryPose> {
        let last = self.readings.last()?;
        let pose = self.graph.poses[last.keyframe] * last.offset;
        Some(super::TrajectoryPose { time_s: last.time_s, pose, state: last.state })
    }

    /// The motion since reading number `from` by matching with local submaps alone, and its covariance, in the frame of the
    /// robot at that reading. `None` if a scan since then did not agree with its submap.
    pub(crate) fn motion_since(&self, from: usize) -> Option<(Isometry2<f64>, Matrix3<f64>)> {
        let since = &self.readings[from + 1..];
        if since.iter().any(|reading| reading.state != PoseState::Tracking) {
            return None;
        }
        let (first, last) = (&self.readings[from], since.last()?);
        let (motion, spread) = self.matched_motion(first.keyframe, last.keyframe)?;
        let back = first.offset.inverse();
        Some((back * motion * last.offset, in_frame(&spread, &first.offset)))
    }

    /// The motion between two keyframes by matching with local submaps alone, without any loop, and its covariance, in the
    /// frame of the first one.
    pub(crate) fn matched_motion(&self, from: usize, to: usize) -> Option<(Isometry2<f64>, Matrix3<f64>)> {
        let is_between = |edge: &&Edge| !edge.is_loop && edge.from >= from && edge.to <= to;
        let (mut motion, mut spread) = (Isometry2::identity(), Matrix3::zeros());
        for edge in self.graph.edges.iter().filter(is_between) {
            let shift = motion.rotation * edge.motion.translation.vector;
            // An error of the heading turns the motion.
            let turned = Matrix3::new(1.0, 0.0, -shift.y, 0.0, 1.0, shift.x, 0.0, 0.0, 1.0);
            let own = in_frame(&edge.information.try_inverse()?, &motion.inverse());
            spread = turned * spread * turned.transpose() + own;
            motion *= edge.motion;
        }
        Some((motion, spread))
    }

    /// Whether the last reading agreed with its submap; invalid readings, and those that show nothing, do not disagree.
    pub(crate) fn is_supported(&self) -> bool {
        self.builder.matcher.sees_nothing
            || self.readings.last().is_some_and(|reading| reading.state != PoseState::Uncertain)
    }

    /// The number of keyframes so far.
    pub(crate) fn keyframe_count(&self) -> usize {
        self.graph.poses.len()
    }

    /// The way from a keyframe to a later one, m; turns count as a way.
    fn way_m(&self, from: usize, to: usize) -> f64 {
        let step_m = |keyframe: usize| {
            let keyframes = self.keyframes();
            let motion = keyframes[keyframe].local.inv_mul(&keyframes[keyframe + 1].local);
            motion.translation.vector.norm() + TURN_M * heading_rad(&motion).abs()
        };
        (from..to).map(step_m).sum()
    }

    /// The loops, in the order in which they were closed.
    pub(crate) fn loops(&self) -> &[RecognizedPlace] {
        &self.closer.accepted
    }

    /// The motion near `motion` at which the two submaps of a loop agree best, and how much agrees there, compared with the
    /// motion of the loop: 1 for as much.
    pub(crate) fn agreement_near(
        &self,
        found: &RecognizedPlace,
        motion: &Isometry2<f64>,
    ) -> Option<(Isometry2<f64>, f64)> {
        let [from, to] = [found.from, found.to].map(|number| &self.closer.places.submaps[number]);
        let map = SurfelMap::of_points(&from.points)?;
        let fit = |motion| fit(&map, &to.points, motion, FOUND_STD, self.closer.places.noise_m);
        let ((near, agrees), (_, most)) = (fit(motion)?, fit(&found.edge.motion)?);
        Some((near.placement.pose, agrees.confirmed / most.confirmed.max(f64::MIN_POSITIVE)))
    }

    /// The way on new ground, and the way since new ground was last seen, m.
    pub(crate) fn ways_on_ground_m(&self) -> (f64, f64) {
        let submaps = &self.closer.places.submaps;
        let at = |anchor: usize| self.graph.poses[anchor].translation.vector;
        let (mut new_m, mut last) = (0.0, 0);
        for (number, submap) in submaps.iter().enumerate() {
            let mut earlier = submaps[..number].iter().filter(|other| other.last < submap.first);
            if earlier.all(|other| (at(other.anchor) - at(submap.anchor)).norm() > NEW_GROUND_M) {
                // The next submap begins in the middle of this one.
                new_m += self.way_m(submap.first, submap.anchor);
                last = submap.last;
            }
        }
        (new_m, self.way_m(last, self.keyframe_count().saturating_sub(1)))
    }
}

//! What is known about the trajectory while the robot still drives.

use super::TrajectoryFinder;
use super::graph::Edge;
use interfaces::heading_rad;
use nalgebra::Isometry2;

/// A submap is on new ground if no earlier one has its middle within this distance, m.
const KNOWN_M: f64 = 4.0;
/// A turn counts as this way, m/rad.
const TURN_M: f64 = 0.3;

impl TrajectoryFinder {
    /// The poses of all readings so far, with all loops that are closed. The pose of the first reading is the origin.
    pub(crate) fn corrected(&self) -> Vec<Isometry2<f64>> {
        self.poses(&self.optimized()).iter().map(|found| found.pose).collect()
    }

    /// The number of keyframes so far.
    pub(crate) fn keyframes(&self) -> usize {
        self.graph.poses.len()
    }

    /// The motion between two keyframes by matching with local submaps alone, without any loop.
    pub(crate) fn matched_motion(&self, from: usize, to: usize) -> Isometry2<f64> {
        let keyframes = self.front_end.keyframes();
        keyframes[from].local.inv_mul(&keyframes[to].local)
    }

    /// The way from a keyframe to a later one, m; turns count as a way.
    pub(crate) fn way_m(&self, from: usize, to: usize) -> f64 {
        let step_m = |keyframe: usize| {
            let motion = self.matched_motion(keyframe, keyframe + 1);
            motion.translation.vector.norm() + TURN_M * heading_rad(&motion).abs()
        };
        (from..to).map(step_m).sum()
    }

    /// The number of loops that are closed.
    pub(crate) fn loops(&self) -> usize {
        self.closer.loops()
    }

    /// The loops from number `first` on: two keyframes, and the motion between them.
    pub(crate) fn loops_since(&self, first: usize) -> impl Iterator<Item = (usize, usize, Isometry2<f64>)> {
        let ends = |Edge { from, to, motion, .. }: &Edge| (*from, *to, *motion);
        self.closer.accepted()[first..].iter().map(move |place| ends(&place.edge))
    }

    /// The way on new ground, and the way since new ground was last seen, m.
    pub(crate) fn ways_on_ground_m(&self) -> (f64, f64) {
        let submaps = &self.closer.places.submaps;
        let at = |anchor: usize| self.graph.poses[anchor].translation.vector;
        let (mut new_m, mut last) = (0.0, 0);
        for (number, submap) in submaps.iter().enumerate() {
            let mut earlier = submaps[..number].iter().filter(|other| other.last < submap.first);
            if earlier.all(|other| (at(other.anchor) - at(submap.anchor)).norm() > KNOWN_M) {
                // The next submap begins in the middle of this one.
                new_m += self.way_m(submap.first, submap.anchor);
                last = submap.last;
            }
        }
        (new_m, self.way_m(last, self.keyframes().saturating_sub(1)))
    }
}

//! The corrections of another SLAM in the transforms of a bag (REP-105): from the frame of its map to that of the odometry, which
//! jumps where the SLAM corrects itself.

use crate::assemble::{Chain, Frames};
use crate::checks::Jumps;
use nalgebra::Isometry2;
use ros::flat;
use std::collections::{BTreeSet, VecDeque};

/// The corrections that are kept: scans wait for later poses.
const KEPT: usize = 512;
/// Times that differ by less are the same, s: they are rounded.
const SAME_S: f64 = 1e-3;

/// The corrections so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Corrections {
    chain: Chain,
    /// The transforms of the chain that are not known yet.
    missing: BTreeSet<usize>,
    /// The poses of the odometry in the map, and since when each of them was known, s; the newest last.
    known: VecDeque<(f64, Isometry2<f64>)>,
    jumps: Jumps,
}

impl Corrections {
    /// Those along a chain. Transforms that never move are known from the begin on.
    pub(super) fn new(chain: &Chain, frames: &Frames) -> Self {
        let missing =
            chain.iter().map(|(index, _)| *index).filter(|index| frames.edge(*index).moves).collect();
        let mut corrections = Self { chain: chain.clone(), missing, ..Self::default() };
        corrections.learn(f64::NEG_INFINITY, frames, &Isometry2::identity());
        corrections
    }

    /// Notes that a transform was set by a message with this time, s, while the odometry has the robot at a pose. Some SLAMs write
    /// later times, until which the transform shall hold: it is known since `newest_s`, the newest time in the bag so far.
    pub(super) fn note(
        &mut self,
        edge: usize,
        frames: &Frames,
        [time_s, newest_s]: [f64; 2],
        robot: &Isometry2<f64>,
    ) {
        if self.chain.iter().any(|(index, _)| *index == edge) {
            self.missing.remove(&edge);
            self.learn(time_s.min(newest_s), frames, robot);
        }
    }

    fn learn(&mut self, time_s: f64, frames: &Frames, robot: &Isometry2<f64>) {
        let now = flat(&frames.along(&self.chain));
        let before = self.known.back().map(|(_, before)| *before);
        if !self.missing.is_empty() || before == Some(now) {
            return;
        }
        if let Some(before) = before {
            self.jumps.add(time_s, &(before * robot).inv_mul(&(now * robot)));
        }
        if self.known.len() == KEPT {
            self.known.pop_front();
        }
        self.known.push_back((time_s, now));
    }

    /// The pose of the odometry in the map, as it was known at a time, s; `None` before the first one.
    pub(super) fn at(&self, time_s: f64) -> Option<Isometry2<f64>> {
        let is_known = |(since_s, _): &&(f64, Isometry2<f64>)| *since_s <= time_s + SAME_S;
        self.known.iter().rev().find(is_known).map(|(_, pose)| *pose)
    }

    /// The corrections; without a frame of odometry, they are jumps of the poses themselves.
    pub(super) fn described(&self, of_poses: &Jumps, begin_s: f64) -> String {
        let jumps = if self.chain.is_empty() { of_poses } else { &self.jumps };
        jumps.described(begin_s)
    }
}

//! Changes that belong together: near each other, at about the same time.

use super::lasting::Change;
use nalgebra::Point2;

/// Changes of one motion are at most this far from each other, m.
const NEAR_M: f64 = 0.25;
/// Those of two motions of at most this number of changes are at most this far from each other, m: the legs of a chair.
const FEW: usize = 8;
const LEGS_M: f64 = 0.6;
/// Changes of one motion begin within this time, s: a leaf moves for one or two seconds.
const TOGETHER_S: f64 = 2.5;
/// A motion is over when nothing was added for this time, s.
const OVER_S: f64 = 1.5;
/// The largest number of changes in a motion, and of motions at a time.
const MAX_CHANGES: usize = 600;
const MAX_MOTIONS: usize = 64;

/// Changes that belong together.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
pub(super) struct Motion {
    pub(super) changes: Vec<Change>,
    /// The corners of the box around them, m.
    corners: [Point2<f64>; 2],
    /// The times of the first and of the last change, s.
    times_s: [f64; 2],
    added_s: f64,
}

impl Motion {
    /// The time of its first change, s.
    pub(super) fn begin_s(&self) -> f64 {
        self.times_s[0]
    }

    fn of(change: Change, at: Point2<f64>, now_s: f64) -> Self {
        Self { changes: vec![change], corners: [at, at], times_s: [change.time_s; 2], added_s: now_s }
    }

    fn is_near(&self, other: &Self) -> bool {
        let [low, high] = &self.corners;
        let [other_low, other_high] = &other.corners;
        let near_m = if self.changes.len().max(other.changes.len()) > FEW { NEAR_M } else { LEGS_M };
        let is_beside =
            |axis: usize| low[axis] - near_m <= other_high[axis] && other_low[axis] <= high[axis] + near_m;
        let is_together = self.times_s[0] - TOGETHER_S <= other.times_s[1]
            && other.times_s[0] <= self.times_s[1] + TOGETHER_S
            && self.times_s[1].max(other.times_s[1]) - self.times_s[0].min(other.times_s[0])
                <= 2.0 * TOGETHER_S;
        is_together && is_beside(0) && is_beside(1)
    }

    fn join(&mut self, other: Self) {
        self.changes.extend(other.changes);
        self.corners = [self.corners[0].inf(&other.corners[0]), self.corners[1].sup(&other.corners[1])];
        self.times_s = [self.times_s[0].min(other.times_s[0]), self.times_s[1].max(other.times_s[1])];
        self.added_s = self.added_s.max(other.added_s);
    }
}

/// The motions that are not over.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(super) struct Motions(Vec<Motion>);

impl Motions {
    /// Adds a change at a place, m.
    pub(super) fn add(&mut self, change: Change, at: Point2<f64>, now_s: f64) {
        let mut motion = Motion::of(change, at, now_s);
        while let Some(near) = self.0.iter().position(|other| other.is_near(&motion)) {
            let mut other = self.0.remove(near);
            other.join(motion);
            motion = other;
        }
        self.0.push(motion);
    }

    pub(super) fn each_cell(&mut self, f: &mut dyn FnMut(&mut u32)) {
        self.0.iter_mut().flat_map(|motion| &mut motion.changes).for_each(|change| f(&mut change.cell));
    }

    /// The next motion that is over.
    pub(super) fn next(&mut self, now_s: f64) -> Option<Motion> {
        let is_crowded = self.0.len() > MAX_MOTIONS;
        let over = self.0.iter().position(|motion| {
            is_crowded || motion.added_s < now_s - OVER_S || motion.changes.len() > MAX_CHANGES
        });
        over.map(|over| self.0.remove(over))
    }
}

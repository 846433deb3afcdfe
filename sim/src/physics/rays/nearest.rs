//! The shortest range of all beams of a sensor.
//!
//! The range of every beam that could be the shortest is computed as for a laser, so that the result is the same, bit
//! for bit. What is farther away than the shortest range so far, and what lies beside the beams, is left out. The nearest
//! things should be added first.

use super::beams::{Beams, EDGE_ON_M};
use super::disc::Disc;
use super::edges::Edge;
use interfaces::approximate_atan2;
use nalgebra::{Isometry2, Point2, Vector2};

/// A body may be left out if it is farther away than the shortest range by this factor: far above rounding.
const SAFE: f64 = Disc::SAFE;
/// A point counts as beside the beams if it is this far beyond their border, m: far above rounding.
const BESIDE_M: f64 = 1e-6;

/// The number of sides of a body that are compared at a time.
const MAX_SIDES: usize = 32;

/// The shortest range so far.
pub(super) struct Nearest<'a> {
    beams: &'a Beams,
    sensor: Isometry2<f64>,
    /// The directions of the first and the last beam in the frame of the world, if the beams span less than half a turn.
    borders: Option<[Vector2<f64>; 2]>,
    /// One over the range, 1/m; 0 where there is no hit.
    pub(super) inverse: f64,
    /// What is farther away cannot change the result, m.
    pub(super) reach_m: f64,
}

impl<'a> Nearest<'a> {
    /// No hits yet.
    pub(super) fn new(beams: &'a Beams, sensor: &Isometry2<f64>) -> Self {
        let border = |beam: usize| Vector2::new(beams.x[beam], beams.y[beam]);
        let [right, left] = [0, beams.count - 1].map(border);
        let is_narrow = beams.count == 1 || right.perp(&left) > 1e-6;
        Self {
            beams,
            sensor: *sensor,
            borders: is_narrow.then(|| [right, left].map(|border| sensor.rotation * border)),
            inverse: 0.0,
            reach_m: beams.range_max_m * SAFE,
        }
    }

    fn take(&mut self, inverse: f64) {
        if inverse > self.inverse {
            self.inverse = inverse;
            self.reach_m = self.reach_m.min(SAFE / inverse);
        }
    }

    /// Whether two points, as seen from the sensor, lie on the same outer side of the beams.
    fn is_beside(&self, a: &Vector2<f64>, b: &Vector2<f64>) -> bool {
        let Some([right, left]) = &self.borders else { return false };
        right.perp(a).max(right.perp(b)) < -BESIDE_M || left.perp(a).min(left.perp(b)) > BESIDE_M
    }

    /// The distance squared from the sensor to an edge, m², if the edge faces the sensor and a beam may hit it within
    /// reach.
    fn distance2_m2(&self, edge: &Edge) -> Option<f64> {
        let at = Point2::from(self.sensor.translation.vector);
        let gap_m = edge.gap_m(&at);
        if gap_m < EDGE_ON_M || gap_m > self.beams.range_max_m || gap_m > self.reach_m {
            return None;
        }
        let (from, to) = (edge.from - at, edge.to - at);
        let along = to - from;
        let distance2 = if along.dot(&from) > 0.0 {
            from.norm_squared()
        } else if along.dot(&to) < 0.0 {
            to.norm_squared()
        } else {
            gap_m * gap_m
        };
        (distance2 <= self.reach_m * self.reach_m && !self.is_beside(&from, &to)).then_some(distance2)
    }

    /// Adds an edge of a solid, if the edge faces the sensor and is within reach.
    pub(super) fn add_edge(&mut self, edge: &Edge) {
        if self.distance2_m2(edge).is_some() {
            self.take_edge(edge);
        }
    }

    /// Adds the sides of a convex body.
    pub(super) fn add_polygon(&mut self, sides: &[Edge]) {
        let mut distances2 = [f64::INFINITY; MAX_SIDES];
        for sides in sides.chunks(MAX_SIDES) {
            let mut nearest = 0;
            for (index, side) in sides.iter().enumerate() {
                distances2[index] = self.distance2_m2(side).unwrap_or(f64::INFINITY);
                if distances2[index] < distances2[nearest] {
                    nearest = index;
                }
            }
            // The nearest side first: most of the others are then out of reach.
            for index in [nearest].into_iter().chain(0..sides.len()) {
                if distances2[index] <= self.reach_m * self.reach_m {
                    self.take_edge(&sides[index]);
                    distances2[index] = f64::INFINITY;
                }
            }
        }
    }

    /// Takes the hits on an edge that faces the sensor.
    fn take_edge(&mut self, edge: &Edge) {
        let gap_m = edge.gap_m(&self.sensor.translation.vector.into());
        let seen = |point: &Point2<f64>| self.sensor.inverse_transform_point(point).coords;
        let (from, to) = (seen(&edge.from), seen(&edge.to));
        let normal = self.sensor.rotation.inverse() * edge.normal;
        let (m, n) = (-normal.x / gap_m, -normal.y / gap_m);
        let mut most = 0.0;
        for run in self.beams.between(&to, &from) {
            for (x, y) in self.beams.x[run.clone()].iter().zip(&self.beams.y[run]) {
                let hit = m * x + n * y;
                most = if hit > most { hit } else { most };
            }
        }
        self.take(most);
    }

    /// The center of a disc in the frame of the sensor, m, and its distance, m, if the disc is within reach and not
    /// beside the beams.
    fn place(&self, disc: &Disc) -> Option<(Vector2<f64>, f64)> {
        let to = disc.center.coords - self.sensor.translation.vector;
        let (distance2, most_m) = (to.norm_squared(), self.reach_m + disc.radius_m);
        if distance2 > most_m * most_m {
            return None;
        }
        let beside_m = disc.radius_m * SAFE + BESIDE_M;
        let is_beside = self
            .borders
            .is_some_and(|[right, left]| right.perp(&to) < -beside_m || left.perp(&to) > beside_m);
        (!is_beside).then(|| (self.sensor.rotation.inverse() * to, distance2.sqrt()))
    }

    /// Whether a body within a disc could change the result.
    pub(super) fn may_meet(&self, around: &Disc) -> bool {
        self.place(around).is_some()
    }

    /// Adds a round body.
    pub(super) fn add_disc(&mut self, disc: &Disc) {
        let Some((center, distance_m)) = self.place(disc) else { return };
        // As in [`Hits`](super::beams::Hits), to the bit.
        let to = disc.center - self.sensor.translation.vector;
        let power = to.coords.norm_squared() - disc.radius_m * disc.radius_m;
        let most_m = self.beams.range_max_m + disc.radius_m;
        if power > most_m * most_m {
            return;
        }
        if power <= 0.0 {
            return self.take(f64::INFINITY);
        }
        let angle_rad = approximate_atan2(center.y, center.x);
        let (first, end) = self.beams.around(angle_rad, disc.half_rad(distance_m));
        let (per_power, mut most) = (1.0 / power, 0.0);
        for run in self.beams.runs(first, end) {
            for (x, y) in self.beams.x[run.clone()].iter().zip(&self.beams.y[run]) {
                let b = center.x * x + center.y * y;
                let root2 = b * b - power;
                let hit = if root2 >= 0.0 { (b + root2.max(0.0).sqrt()) * per_power } else { 0.0 };
                most = if hit > most { hit } else { most };
            }
        }
        self.take(most);
    }
}

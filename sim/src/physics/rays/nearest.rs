//! The shortest range of all beams of a sensor.
//!
//! The range of every beam that could be the shortest is computed as for a laser, so that the result is the same, bit
//! for bit. What is farther away than the shortest range so far, and what lies beside the beams, is left out. The nearest
//! things should be added first.

use super::beams::{Beams, EDGE_ON_M, Hits};
use super::disc::Disc;
use super::edges::Edge;
use super::sectors::is_beside;
use nalgebra::{Isometry2, Point2, Vector2};

/// A body may be left out if it is farther away than the shortest range by this factor: far above rounding.
const SAFE: f64 = Disc::SAFE;
/// A point counts as beside the beams if it is this far beyond their border, m: far above rounding.
const BESIDE_M: f64 = 1e-6;

/// The number of sides of a body that are compared at a time.
const MAX_SIDES: usize = 32;

/// The hits of the beams that could have the shortest range.
pub(super) struct Nearest<'a> {
    hits: Hits<'a>,
    /// The directions of the first and the last beam in the frame of the world, if the beams span less than half a turn.
    borders: Option<[Vector2<f64>; 2]>,
    /// What is farther away cannot change the result, m.
    pub(super) reach_m: f64,
}

impl<'a> Nearest<'a> {
    /// No hits yet. `inverse`: a buffer.
    pub(super) fn new(beams: &'a Beams, sensor: &Isometry2<f64>, inverse: &'a mut Vec<f64>) -> Self {
        let border = |beam: usize| Vector2::new(beams.x[beam], beams.y[beam]);
        let [right, left] = [0, beams.count - 1].map(border);
        let is_narrow = beams.count == 1 || right.perp(&left) > 1e-6;
        Self {
            hits: Hits::new(beams, sensor, inverse),
            borders: is_narrow.then(|| [right, left].map(|border| sensor.rotation * border)),
            reach_m: beams.range_max_m * SAFE,
        }
    }

    /// One over the shortest range so far, 1/m; 0 where there is no hit.
    pub(super) fn inverse(&self) -> f64 {
        self.hits.inverse.iter().copied().fold(0.0, f64::max)
    }

    fn update_reach(&mut self) {
        self.reach_m = self.reach_m.min(SAFE / self.inverse());
    }

    /// The distance squared from the sensor to an edge, m², if the edge faces the sensor and a beam may hit it within
    /// reach.
    fn distance2_m2(&self, edge: &Edge) -> Option<f64> {
        let at = Point2::from(self.hits.laser.translation.vector);
        let gap_m = edge.gap_m(&at);
        if gap_m < EDGE_ON_M || gap_m > self.hits.beams.range_max_m || gap_m > self.reach_m {
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
        let is_in_reach = distance2 <= self.reach_m * self.reach_m;
        (is_in_reach && !is_beside(&self.borders, [&from, &to], BESIDE_M)).then_some(distance2)
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

    fn take_edge(&mut self, edge: &Edge) {
        self.hits.add_edge(edge);
        self.update_reach();
    }

    /// Whether a body within a disc could change the result.
    pub(super) fn may_meet(&self, around: &Disc) -> bool {
        let to = around.center.coords - self.hits.laser.translation.vector;
        let (max_m, beside_m) = (self.reach_m + around.radius_m, around.radius_m * SAFE + BESIDE_M);
        to.norm_squared() <= max_m * max_m && !is_beside(&self.borders, [&to, &to], beside_m)
    }

    /// Adds a round body.
    pub(super) fn add_disc(&mut self, disc: &Disc) {
        if self.may_meet(disc) {
            self.hits.add_disc(disc);
            self.update_reach();
        }
    }
}

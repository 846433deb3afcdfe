//! The exact ray caster: all beams of a scan at once.
//!
//! The usual caster asks, for every beam, what it hits. Here every body asks which beams can hit
//! it, and only these are looked at: the cost is the number of bodies plus the beams that they
//! fill, not their product. All is done in the laser's frame, where the directions of the beams
//! never change, and in inverse ranges, where a straight edge is a plain dot product: the ray
//! `t·d` meets the line `n·x = c` at `1/t = (n/c)·d`, and the nearest hit is the largest value.

use nalgebra::{Isometry2, Point2};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// An edge whose line passes the laser closer than this is seen edge-on, m.
const EDGE_ON_M: f64 = 1e-9;

/// The beams of a laser, and the nearest hit on each of them.
#[derive(Clone, Debug)]
pub(super) struct Fan {
    angle_min_rad: f64,
    angle_increment_rad: f64,
    range_max_m: f64,
    /// The beams' unit vectors in the laser's frame.
    x: Vec<f64>,
    y: Vec<f64>,
    /// One over the range, 1/m; 0 where there is no hit.
    inverse: Vec<f64>,
}

impl Fan {
    /// `beams` beams, the first along `angle_min_rad`, `angle_increment_rad` apart; bodies beyond
    /// `range_max_m` may be left out.
    pub(super) fn new(angle_min_rad: f64, angle_increment_rad: f64, beams: usize, range_max_m: f64) -> Self {
        let angle = |i: usize| angle_min_rad + i as f64 * angle_increment_rad;
        let (y, x) = (0..beams).map(|i| libm::sincos(angle(i))).unzip();
        Self { angle_min_rad, angle_increment_rad, range_max_m, x, y, inverse: vec![0.0; beams] }
    }

    /// Forgets every hit.
    pub(super) fn clear(&mut self) {
        self.inverse.fill(0.0);
    }

    /// The ranges of the nearest hits, m; infinite where there is none.
    pub(super) fn ranges_m(&self) -> impl Iterator<Item = f64> {
        self.inverse.iter().map(|inverse| 1.0 / inverse)
    }

    /// The unit vectors of the beams in the laser's frame.
    pub(super) fn directions(&self) -> impl Iterator<Item = (f64, f64)> {
        self.x.iter().copied().zip(self.y.iter().copied())
    }

    /// Adds a convex body by its corners (m, counter-clockwise), seen by a laser at `laser`.
    pub(super) fn add_polygon<const N: usize>(&mut self, laser: &Isometry2<f64>, corners: &[Point2<f64>; N]) {
        let corners = corners.map(|corner| laser.inverse_transform_point(&corner));
        let mut at = [f64::NAN; N];
        let mut outside = false;
        for i in 0..N {
            let j = (i + 1) % N;
            let (p, q) = (corners[i], corners[j]);
            // The normal points outwards: the laser sees the edge from its outer side.
            let normal = (q.y - p.y, p.x - q.x);
            let offset = normal.0 * p.x + normal.1 * p.y;
            outside |= offset < 0.0;
            let length = (normal.0 * normal.0 + normal.1 * normal.1).sqrt();
            if offset > -EDGE_ON_M * length || offset < -self.range_max_m * length {
                continue;
            }
            for end in [i, j] {
                if at[end].is_nan() {
                    at[end] = self.beam_at(libm::atan2(corners[end].y, corners[end].x));
                }
            }
            // Seen from outside, the sides of a counter-clockwise body run clockwise.
            let (m, n) = (normal.0 / offset, normal.1 / offset);
            for beams in self.beams_between(at[j], at[i]) {
                let directions = self.x[beams.clone()].iter().zip(&self.y[beams.clone()]);
                for (inverse, (x, y)) in self.inverse[beams].iter_mut().zip(directions) {
                    let hit = m * x + n * y;
                    *inverse = if hit > *inverse { hit } else { *inverse };
                }
            }
        }
        if !outside {
            self.inverse.fill(f64::INFINITY);
        }
    }

    /// Adds a round body, seen by a laser at `laser`.
    pub(super) fn add_disc(&mut self, laser: &Isometry2<f64>, center: &Point2<f64>, radius_m: f64) {
        let center = laser.inverse_transform_point(center);
        let distance_m = center.coords.norm();
        if distance_m - radius_m > self.range_max_m {
            return;
        }
        let power = (distance_m - radius_m) * (distance_m + radius_m);
        if power <= 0.0 {
            return self.inverse.fill(f64::INFINITY);
        }
        let toward = libm::atan2(center.y, center.x);
        let half = libm::asin(radius_m / distance_m);
        let (from, to) = (self.beam_at(toward - half), self.beam_at(toward + half));
        for beams in self.beams_between(from, to) {
            let directions = self.x[beams.clone()].iter().zip(&self.y[beams.clone()]);
            for (inverse, (x, y)) in self.inverse[beams].iter_mut().zip(directions) {
                // The nearer root of t² − 2bt + power = 0 is power / (b + √(b² − power)).
                let b = center.x * x + center.y * y;
                let hit = (b + (b * b - power).max(0.0).sqrt()) / power;
                *inverse = if hit > *inverse { hit } else { *inverse };
            }
        }
    }

    /// The place of a direction among the beams, in [0, beams of a full turn].
    fn beam_at(&self, angle_rad: f64) -> f64 {
        let turn = angle_rad - self.angle_min_rad;
        (turn - TAU * libm::floor(turn / TAU)) / self.angle_increment_rad
    }

    /// The beams that lie counter-clockwise from place `from` to place `to`, less than half a turn
    /// apart: one run, or two where they pass the start.
    fn beams_between(&self, from: f64, to: f64) -> [Range<usize>; 2] {
        let beams = self.x.len();
        // Both are in range: a place is neither negative nor NaN.
        let first = (libm::ceil(from) as usize).min(beams);
        let last = (libm::floor(to) as usize + 1).min(beams);
        if from <= to {
            [first..last.max(first), 0..0]
        } else if (from - to) * self.angle_increment_rad > PI {
            [first..beams, 0..last]
        } else {
            // Thinner than rounding: no beam hits it.
            [0..0, 0..0]
        }
    }
}

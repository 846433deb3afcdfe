//! All beams of a scan at once.
//!
//! The frame is that of the laser, in which the directions of the beams never change. Ranges are inverse, so
//! that a straight edge is a dot product: the ray `t·d` hits the line `n·x = c` at `1/t = (n/c)·d`, and the
//! nearest hit is the largest value.

use super::disc::Disc;
use super::edges::Edge;
use interfaces::{APPROXIMATE_ATAN2_ERROR_RAD, approximate_atan2};
use nalgebra::{Isometry2, Point2, Vector2};
use std::f64::consts::PI;
use std::ops::Range;

/// An edge whose line passes the laser closer than this is seen edge-on, m.
pub(super) const EDGE_ON_M: f64 = 1e-9;

/// The directions of the beams of a laser.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::physics) struct Beams {
    pub(super) count: usize,
    angle_min_rad: f64,
    per_rad: f64,
    pub(super) range_max_m: f64,
    /// The unit vectors in the frame of the laser. Those of a full turn end with a copy of the first.
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
}

impl Beams {
    /// `count` beams, the first along `angle_min_rad`, `angle_increment_rad` apart, symmetrical to straight
    /// ahead. Bodies beyond `range_max_m` may be ignored.
    pub(in crate::physics) fn new(
        angle_min_rad: f64,
        angle_increment_rad: f64,
        count: usize,
        range_max_m: f64,
    ) -> Self {
        let angle = |i: usize| angle_min_rad + i as f64 * angle_increment_rad;
        let (mut y, mut x): (Vec<f64>, Vec<f64>) = (0..count).map(|i| libm::sincos(angle(i))).unzip();
        if angle_min_rad <= -PI {
            x.push(x[0]);
            y.push(y[0]);
        }
        Self { count, angle_min_rad, per_rad: 1.0 / angle_increment_rad, range_max_m, x, y }
    }

    /// The unit vectors of the beams in the frame of the laser.
    pub(in crate::physics) fn directions(&self) -> impl Iterator<Item = (f64, f64)> {
        self.x.iter().copied().zip(self.y.iter().copied()).take(self.count)
    }

    /// The place of the direction of `v` among the beams. Beam 0 of a full turn counts once more at the end.
    ///
    /// Cross products decide the side, alike for every edge that ends in `v`: no beam passes between two edges.
    #[inline]
    fn bearing(&self, v: &Vector2<f64>) -> Bearing {
        let angle_rad = approximate_atan2(v.y, v.x);
        let cross = |i: usize| v.x * self.y[i] - v.y * self.x[i];
        let index = (angle_rad - self.angle_min_rad) * self.per_rad;
        let mut first = if index < 0.0 { 0 } else { (index as usize + 1).min(self.x.len()) };
        // The approximate angle may be wrong about beams as near as this, and about no other.
        let near = APPROXIMATE_ATAN2_ERROR_RAD * self.per_rad;
        while first > 0 && index - ((first - 1) as f64) < near && cross(first - 1) >= 0.0 {
            first -= 1;
        }
        let is_near = |i: usize| i < self.x.len() && i as f64 - index < near;
        while is_near(first) && cross(first) < 0.0 {
            first += 1;
        }
        let mut end = first;
        while is_near(end) && cross(end) <= 0.0 {
            end += 1;
        }
        Bearing { angle_rad, first, end }
    }

    /// The beams from `from` to `to`, counter-clockwise, less than half a turn apart, both included: one range,
    /// or two where the beams pass the back.
    #[inline]
    fn runs_between(&self, from: &Bearing, to: &Bearing) -> [Range<usize>; 2] {
        let (mut first, mut end) = (from.first, to.end);
        if to.angle_rad - from.angle_rad < -PI {
            end += self.count;
        } else if to.angle_rad - from.angle_rad > PI {
            // Both are at the back, on one line of sight except for rounding.
            first += self.count;
        }
        self.runs((first, end))
    }

    /// The beams that are less than `half_rad` away from `angle_rad`, and perhaps a few more: the index of the
    /// first, and the index after the last. Indices continue after the last beam of all.
    #[inline]
    pub(super) fn around(&self, angle_rad: f64, half_rad: f64) -> (usize, usize) {
        // By way of 32 bits, since that takes three instructions and not ten. In a narrow view, directions beyond the
        // last beam count as the end.
        let index = |angle_rad: f64| {
            ((((angle_rad - self.angle_min_rad) * self.per_rad) as i32).max(0) as usize).min(self.count)
        };
        let (low, high) = (angle_rad - half_rad, angle_rad + half_rad);
        if low < -PI {
            // The back, seen from the right: the end of the beams.
            (index(low + 2.0 * PI), index(high) + 1 + self.count)
        } else if high > PI {
            (index(low), index(high - 2.0 * PI) + 1 + self.count)
        } else {
            (index(low), index(high) + 1)
        }
    }

    /// The beams of `first..end`, where indices continue after the last beam.
    #[inline]
    pub(super) fn runs(&self, (first, end): (usize, usize)) -> [Range<usize>; 2] {
        let count = self.count;
        let (low, high) = (first.min(count), end.min(count));
        // In a narrow view, indices behind the view may continue past the end a second time.
        let again = first.saturating_sub(count).min(count);
        let last = end.saturating_sub(count).min(count);
        [low..high.max(low), again..last.max(again)]
    }
}

/// The place of a direction among the beams.
struct Bearing {
    /// The direction, approximately.
    angle_rad: f64,
    /// The first beam that lies along the direction or counter-clockwise of it, and the first one that lies
    /// counter-clockwise of it.
    first: usize,
    end: usize,
}

/// Where a disc lies, seen from a laser.
enum Place {
    /// Out of range.
    Beyond,
    /// Around the laser.
    Around,
    /// In a direction.
    At {
        /// The center in the frame of the laser, m.
        center: Vector2<f64>,
        /// The power of the laser position: distance squared less radius squared, m²; positive.
        power: f64,
        /// The direction of the center, approximately, and the half width, at least the true one, rad.
        angle_rad: f64,
        half_rad: f64,
        /// One over the shortest range, at least the true value, 1/m.
        nearest: f64,
    },
}

/// The nearest hit on each beam of a laser.
pub(super) struct Hits<'a> {
    pub(super) beams: &'a Beams,
    /// One over the range, 1/m; 0 where there is no hit.
    pub(super) inverse: &'a mut [f64],
    /// The pose of the laser.
    pub(super) laser: Isometry2<f64>,
}

impl<'a> Hits<'a> {
    /// No hits yet.
    pub(super) fn new(beams: &'a Beams, laser: &Isometry2<f64>, inverse: &'a mut Vec<f64>) -> Self {
        inverse.clear();
        inverse.resize(beams.count, 0.0);
        Self { beams, inverse, laser: *laser }
    }

    /// The laser is inside of a body: all ranges are 0.
    pub(super) fn add_inside(&mut self) {
        self.inverse.fill(f64::INFINITY);
    }

    /// Adds an edge of a solid, if the edge faces the laser and is within range.
    pub(super) fn add_edge(&mut self, edge: &Edge) {
        if let Some(gap_m) = self.gap_m(edge) {
            let (from, to) = (self.bearing(&edge.from), self.bearing(&edge.to));
            self.add_between(edge, gap_m, &from, &to);
        }
    }

    /// Adds all sides of a convex body, in order: two sides share a corner.
    fn add_polygon(&mut self, edges: &[Edge]) {
        let mut shared: Option<Bearing> = None;
        for edge in edges {
            let from = shared.take();
            if let Some(gap_m) = self.gap_m(edge) {
                let from = from.unwrap_or_else(|| self.bearing(&edge.from));
                let to = self.bearing(&edge.to);
                self.add_between(edge, gap_m, &from, &to);
                shared = Some(to);
            }
        }
    }

    /// The distance from the laser to the line of an edge, m; `None` if the edge faces away or is out of range.
    #[inline]
    fn gap_m(&self, edge: &Edge) -> Option<f64> {
        let gap_m = edge.gap_m(&self.laser.translation.vector.into());
        (gap_m >= EDGE_ON_M && gap_m <= self.beams.range_max_m).then_some(gap_m)
    }

    #[inline]
    fn bearing(&self, point: &Point2<f64>) -> Bearing {
        self.beams.bearing(&self.laser.inverse_transform_point(point).coords)
    }

    #[inline]
    fn add_between(&mut self, edge: &Edge, gap_m: f64, from: &Bearing, to: &Bearing) {
        let normal = self.laser.rotation.inverse() * edge.normal;
        let (m, n) = (-normal.x / gap_m, -normal.y / gap_m);
        // Seen from outside, the sides of a counter-clockwise polygon run clockwise.
        for run in self.beams.runs_between(to, from) {
            let directions = self.beams.x[run.clone()].iter().zip(&self.beams.y[run.clone()]);
            for (inverse, (x, y)) in self.inverse[run].iter_mut().zip(directions) {
                let hit = m * x + n * y;
                *inverse = if hit > *inverse { hit } else { *inverse };
            }
        }
    }

    /// Where a disc lies, seen from the laser.
    #[inline(always)]
    fn place(&self, disc: &Disc) -> Place {
        let to = (disc.center - self.laser.translation.vector).coords;
        let distance2 = to.norm_squared();
        let power = distance2 - disc.radius_m * disc.radius_m;
        let reach_m = self.beams.range_max_m + disc.radius_m;
        if power > reach_m * reach_m {
            return Place::Beyond;
        }
        if power <= 0.0 {
            return Place::Around;
        }
        let (center, distance_m) = (self.laser.rotation.inverse() * to, distance2.sqrt());
        let gap_m = distance_m - disc.radius_m;
        // A gap as small as rounding errors counts as zero.
        let nearest = if gap_m > distance_m * 1e-9 { Disc::SAFE / gap_m } else { f64::INFINITY };
        let angle_rad = approximate_atan2(center.y, center.x);
        Place::At { center, power, angle_rad, half_rad: disc.half_rad(distance_m), nearest }
    }

    /// Adds a round body. A laser inside of it sees nothing else.
    #[inline]
    pub(super) fn add_disc(&mut self, disc: &Disc) {
        match self.place(disc) {
            Place::Beyond => {}
            Place::Around => self.add_inside(),
            Place::At { center, power, angle_rad, half_rad, nearest } => {
                let runs = self.beams.runs(self.beams.around(angle_rad, half_rad));
                runs.into_iter().for_each(|run| self.add_disc_to(run, &center, power, nearest));
            }
        }
    }

    /// Adds a convex body within a disc, unless the disc is out of range or hidden.
    pub(super) fn add_polygon_in(&mut self, around: &Disc, edges: &[Edge]) {
        let may_be_seen = match self.place(around) {
            Place::Beyond => false,
            Place::Around => true,
            Place::At { angle_rad, half_rad, nearest, .. } => !self.is_hidden(angle_rad, half_rad, nearest),
        };
        if may_be_seen {
            self.add_polygon(edges);
        }
    }

    /// Whether nearer bodies hide everything with directions less than `half_rad` away from `angle_rad` and inverse
    /// ranges of at most `nearest`.
    pub(super) fn is_hidden(&self, angle_rad: f64, half_rad: f64, nearest: f64) -> bool {
        let runs = self.beams.runs(self.beams.around(angle_rad, half_rad));
        runs.into_iter().all(|run| self.inverse[run].iter().all(|&inverse| inverse >= nearest))
    }

    #[inline]
    pub(super) fn add_disc_to(&mut self, run: Range<usize>, center: &Vector2<f64>, power: f64, nearest: f64) {
        let inverse = &mut self.inverse[run.clone()];
        if inverse.iter().all(|&inverse| inverse >= nearest) {
            return;
        }
        let per_power = 1.0 / power;
        let directions = self.beams.x[run.clone()].iter().zip(&self.beams.y[run]);
        for (inverse, (x, y)) in inverse.iter_mut().zip(directions) {
            // The nearer root of t² − 2bt + power = 0 is power / (b + √(b² − power)).
            let b = center.x * x + center.y * y;
            let root2 = b * b - power;
            let hit = if root2 >= 0.0 { (b + root2.max(0.0).sqrt()) * per_power } else { 0.0 };
            *inverse = if hit > *inverse { hit } else { *inverse };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every beam lies on one side of a direction, exactly, wherever the direction is.
    #[test]
    fn the_beams_between_two_directions_are_those_that_lie_there() {
        for (fov_rad, count, full) in
            [(2.0 * PI, 360, true), (2.0 * PI, 7, true), (1.0, 11, false), (6.2, 50, false)]
        {
            let gaps = if full { count } else { count - 1 };
            let step_rad = fov_rad / gaps as f64;
            let beams = Beams::new(-fov_rad / 2.0, step_rad, count, 10.0);
            for start in -700..700 {
                for width in [0.0, 1e-9, 1e-5, 0.02, 0.5, 3.1] {
                    // Every seventh starts exactly on a beam, or on the back.
                    let from_rad = if start % 7 == 0 {
                        f64::from(start / 7) * step_rad
                    } else {
                        f64::from(start) * 0.009
                    };
                    let vector = |angle_rad: f64| {
                        let (y, x) = libm::sincos(angle_rad);
                        Vector2::new(x, y) * 3.0
                    };
                    let (from, to) = (vector(from_rad), vector(from_rad + width));
                    let mut chosen = vec![false; count];
                    beams
                        .runs_between(&beams.bearing(&from), &beams.bearing(&to))
                        .into_iter()
                        .flatten()
                        .for_each(|beam| chosen[beam] = true);
                    let expected: Vec<bool> = beams
                        .directions()
                        .map(|(x, y)| {
                            let d = Vector2::new(x, y);
                            from.perp(&d) >= 0.0 && d.perp(&to) >= 0.0 && d.dot(&(from + to)) > 0.0
                        })
                        .collect();
                    assert_eq!(chosen, expected, "{count} beams, {from_rad} rad, {width} rad wide");
                }
            }
        }
    }
}

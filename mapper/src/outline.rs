//! The surfaces in one scan: which beams ended on the same one, and what lies just behind.

use crate::projection::PointCloud;
use nalgebra::{Point2, Vector2};
use std::f64::consts::FRAC_1_SQRT_2;

/// The direction of a surface is taken over neighbours about this far away, m, so that range noise
/// does not turn it.
const CHORD_M: f64 = 0.075;
/// A surface whose two sides meet at more than 25° turns a corner.
const CORNER_COS: f64 = 0.9;

/// The end points of one scan, joined to surfaces.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outline {
    /// Per beam the end point if it hit something, m.
    pub(crate) ends: Vec<Option<Point2<f64>>>,
    /// Per beam whether the next beam hit the same surface.
    pub(crate) joined: Vec<bool>,
    /// Per beam the first and the last beam of its surface. A surface behind the seam of a full
    /// turn counts as two.
    surfaces: Vec<(usize, usize)>,
}

/// A beam to either side on the same surface, and the chords to where they end, m.
struct Sides {
    before: usize,
    after: usize,
    back: Vector2<f64>,
    ahead: Vector2<f64>,
}

impl Sides {
    fn turns_corner(&self) -> bool {
        let along = self.ahead.dot(&self.back);
        along > 0.0
            || along * along < CORNER_COS * CORNER_COS * self.ahead.norm_squared() * self.back.norm_squared()
    }
}

impl Outline {
    /// Finds the end points, and which neighbours lie on one surface: those nearer than `join_m`.
    pub(crate) fn trace(&mut self, cloud: &PointCloud, join_m: f64) {
        self.ends.clear();
        self.ends.extend((0..cloud.len()).map(|beam| cloud.hit(beam)));
        self.joined.clear();
        self.joined.extend((0..cloud.len()).map(|beam| {
            let next = cloud.next(beam).and_then(|next| self.ends[next]);
            matches!((self.ends[beam], next), (Some(a), Some(b)) if (b - a).norm_squared() < join_m * join_m)
        }));
        self.surfaces.clear();
        let mut first = 0;
        for last in 0..cloud.len() {
            if !self.joined[last] || last + 1 == cloud.len() {
                self.surfaces.resize(last + 1, (first, last));
                first = last + 1;
            }
        }
    }

    /// Whether a hit is the first or the last of its surface, where the normal says little.
    pub(crate) fn is_edge(&self, beam: usize) -> bool {
        let (first, last) = self.surfaces[beam];
        beam == first || beam == last
    }

    /// The point that a hit counts for: `depth_m` behind the surface along its normal; at the edge of
    /// what can be seen of the surface, as far inward along the surface too, since the body may end
    /// right behind the edge. Where a neighbouring beam can see that point (the normal led out of a
    /// corner), half as deep along the beam.
    pub(crate) fn behind(
        &self,
        beam: usize,
        end: &Point2<f64>,
        depth_m: f64,
        cloud: &PointCloud,
    ) -> Point2<f64> {
        let inward = self.inward(beam, end, cloud);
        let direction = inward.map_or_else(
            || -self.normal(beam, end, cloud),
            |inward| (inward - self.normal(beam, end, cloud)) * FRAC_1_SQRT_2,
        );
        let along_beam = cloud.directions[beam];
        let distance_m = cloud.returns[beam].clear_m() + direction.dot(&along_beam) * depth_m;
        // From the beam to the point's direction, in beams; the angle is small.
        let turn = along_beam.perp(&direction) * depth_m / (distance_m * cloud.increment_rad);
        let beams = cloud.len() as i32;
        let sees = |step: i32| {
            let at = beam as i32 + step;
            let at = if at < 0 {
                at + beams
            } else if at >= beams {
                at - beams
            } else {
                at
            };
            cloud.returns[at as usize].clear_m() > distance_m + depth_m / 2.0
        };
        let is_seen = turn.abs() < f64::from(beams - 1) && {
            let step = turn as i32 - i32::from(turn < 0.0);
            sees(step) || sees(step + 1)
        };
        end + if is_seen { along_beam * (depth_m / 2.0) } else { direction * depth_m }
    }

    /// At a hit beyond which a neighbouring beam passes: the direction along the surface, away from
    /// that edge.
    fn inward(&self, beam: usize, end: &Point2<f64>, cloud: &PointCloud) -> Option<Vector2<f64>> {
        let (first, last) = self.surfaces[beam];
        let passes = |neighbour: usize| cloud.returns[neighbour].clear_m() > cloud.returns[beam].clear_m();
        let toward = |neighbour: usize| (self.ends[neighbour]? - end).try_normalize(1e-6);
        if first == last {
            None
        } else if beam == first && beam > 0 && passes(beam - 1) {
            toward(beam + 1)
        } else if beam == last && beam + 1 < cloud.len() && passes(beam + 1) {
            toward(beam - 1)
        } else {
            None
        }
    }

    /// The neighbours that tell the direction of the surface at a hit.
    fn sides(&self, beam: usize, end: &Point2<f64>, cloud: &PointCloud) -> Sides {
        let range_m = cloud.returns[beam].clear_m();
        let step = 1 + ((CHORD_M / (range_m * cloud.spacing_rad)) as u32 as usize).min(cloud.len());
        let (first, last) = self.surfaces[beam];
        let (before, after) = (beam.saturating_sub(step).max(first), (beam + step).min(last));
        let chord = |to: usize| self.ends[to].map_or_else(Vector2::zeros, |to| to - end);
        Sides { before, after, back: chord(before), ahead: chord(after) }
    }

    /// The normal of the surface at a hit, towards the sensor. Where the surface turns a corner,
    /// that of the straighter side: a normal across the corner would point out of the body.
    fn normal(&self, beam: usize, end: &Point2<f64>, cloud: &PointCloud) -> Vector2<f64> {
        let sides = self.sides(beam, end, cloud);
        let Sides { before, after, back, ahead } = sides;
        let tangent = if !sides.turns_corner() {
            ahead - back
        } else if self.bend_m(beam, after) <= self.bend_m(beam, before) {
            ahead
        } else {
            -back
        };
        let length_m = tangent.norm();
        if length_m < 1e-6 {
            return -cloud.directions[beam];
        }
        let normal = Vector2::new(-tangent.y, tangent.x) / length_m;
        if normal.dot(&cloud.directions[beam]) > 0.0 { -normal } else { normal }
    }

    /// How far the surface bends away from the chord between two of its hits, m; ∞ where no hit
    /// between them tells.
    fn bend_m(&self, from: usize, to: usize) -> f64 {
        let middle = from.midpoint(to);
        match (self.ends[from], self.ends[middle], self.ends[to]) {
            (Some(a), Some(b), Some(c)) if middle != from && middle != to => {
                (b - a).perp(&(c - a)).abs() / (c - a).norm()
            }
            _ => f64::INFINITY,
        }
    }
}

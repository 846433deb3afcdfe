//! Scan segmentation: which neighboring beams of one scan ended on the same surface, and the normals of the surfaces.

use super::projection::ProjectedScan;
use nalgebra::{Point2, Vector2};

/// The direction of a surface is computed from chords of about this length, m, so that range noise does not affect
/// it.
const CHORD_M: f64 = 0.075;
/// A surface whose two sides meet at more than 25° turns a corner.
const CORNER_COS: f64 = 0.9;
/// Beside a corner, a side that is bent by more than this, m, goes round the corner.
const BEND_M: f64 = 0.01;

/// The end points of one scan, joined to surfaces.
#[derive(Clone, Debug, Default)]
pub(super) struct Segmentation {
    /// For each beam the end point of its hit, m.
    pub(super) ends: Vec<Option<Point2<f64>>>,
    /// For each beam whether the next beam hit the same surface.
    pub(super) joined: Vec<bool>,
    /// For each beam the first and the last beam of its surface. A surface across the seam of a full turn counts as
    /// two surfaces.
    surfaces: Vec<(usize, usize)>,
}

impl Segmentation {
    /// Finds the end points, and the neighboring beams on one surface: those whose end points are nearer to each
    /// other than `join_m`.
    pub(super) fn segment(&mut self, scan: &ProjectedScan, join_m: f64) {
        self.ends.clear();
        self.ends.extend((0..scan.len()).map(|beam| scan.hit(beam)));
        self.joined.clear();
        self.joined.extend((0..scan.len()).map(|beam| {
            let next = scan.next(beam).and_then(|next| self.ends[next]);
            matches!((self.ends[beam], next), (Some(a), Some(b)) if (b - a).norm_squared() < join_m * join_m)
        }));
        self.surfaces.clear();
        let mut first = 0;
        for last in 0..scan.len() {
            if !self.joined[last] || last + 1 == scan.len() {
                self.surfaces.resize(last + 1, (first, last));
                first = last + 1;
            }
        }
    }

    /// At an edge, where a neighboring beam passes the hit: the direction along the surface, away from
    /// the edge.
    pub(super) fn inward(&self, beam: usize, at: &Point2<f64>, scan: &ProjectedScan) -> Option<Vector2<f64>> {
        let (first, last) = self.surfaces[beam];
        let passes = |neighbour: usize| scan.returns[neighbour].clear_m() > scan.returns[beam].clear_m();
        let toward = |neighbour: usize| (self.ends[neighbour]? - at).try_normalize(1e-6);
        if first == last {
            None
        } else if beam == first && beam > 0 && passes(beam - 1) {
            toward(beam + 1)
        } else if beam == last && beam + 1 < scan.len() && passes(beam + 1) {
            toward(beam - 1)
        } else {
            None
        }
    }

    /// The normal of the surface at a hit, toward the sensor. At a corner of the surface, the normal of the
    /// straighter side: a normal across the corner would point out of the body. `None` without a straight side.
    pub(super) fn normal(&self, beam: usize, at: &Point2<f64>, scan: &ProjectedScan) -> Option<Vector2<f64>> {
        let range_m = scan.returns[beam].clear_m();
        let step = 1 + ((CHORD_M / (range_m * scan.spacing_rad)) as u32 as usize).min(scan.len());
        let (first, last) = self.surfaces[beam];
        // One beam to each side on the same surface, and the chords to their end points, m.
        let (before, after) = (beam.saturating_sub(step).max(first), (beam + step).min(last));
        let chord = |to: usize| self.ends[to].map_or_else(Vector2::zeros, |to| to - at);
        let (back, ahead) = (chord(before), chord(after));
        let along = ahead.dot(&back);
        let turns_corner = along > 0.0
            || along * along < CORNER_COS * CORNER_COS * ahead.norm_squared() * back.norm_squared();
        let tangent = if !turns_corner {
            ahead - back
        } else {
            match (self.bend_m(beam, before), self.bend_m(beam, after)) {
                (before_m, after_m) if before_m.min(after_m) > BEND_M => return None,
                (before_m, after_m) if after_m <= before_m => ahead,
                _ => -back,
            }
        };
        let tangent = tangent.try_normalize(1e-6)?;
        let normal = Vector2::new(-tangent.y, tangent.x);
        Some(if normal.dot(&scan.directions[beam]) > 0.0 { -normal } else { normal })
    }

    /// The distance of the surface from the chord between two of its hits, m. [`BEND_M`] for neighboring hits: a side
    /// that is known to be straight is better. ∞ for a side without a hit.
    fn bend_m(&self, from: usize, to: usize) -> f64 {
        let middle = from.midpoint(to);
        match (self.ends[from], self.ends[middle], self.ends[to]) {
            _ if from == to => f64::INFINITY,
            (Some(a), Some(b), Some(c)) if middle != from && middle != to => {
                (b - a).perp(&(c - a)).abs() / (c - a).norm()
            }
            _ => BEND_M,
        }
    }
}

//! Bodies: the cells inside of a new obstacle, which no beam can show.

use super::{Surface, SurfaceGrid, SurfaceGridSettings};
use crate::change::CellMap;
use crate::occupancy::inverse_sensor_model::{NOISE_STDS, passes};
use crate::occupancy::projection::ProjectedScan;
use interfaces::{Cell, CellState};
use nalgebra::{Point2, Vector2};

/// A body touches a cell if the center of the cell is nearer to the body than half a cell. Noise takes a part of this
/// distance: less at the visible side, more at the far side, which follows from several hits. In cells.
const REACH: [f64; 2] = [0.4, 0.2];

/// The body of an obstacle, as far as one scan shows it: the convex outline of the hits, and the same outline turned
/// by 180° about the middle between the first and the last hit.
#[derive(Clone, Debug, Default)]
pub(super) struct Body {
    /// The corners of the visible outline, in the order of the beams.
    corners: Vec<Point2<f64>>,
    /// −1 if the body is on the right of its outline (beams turn counter-clockwise), 1 if it is on the left.
    side: f64,
}

impl Body {
    /// Wraps the hits of consecutive beams.
    fn wrap(&mut self, hits: &[Point2<f64>], is_clockwise: bool) {
        self.side = if is_clockwise { 1.0 } else { -1.0 };
        self.corners.clear();
        for &hit in hits {
            while let [.., before, last] = self.corners[..]
                && self.depth_m(&before, &last, &hit) <= 0.0
            {
                self.corners.pop();
            }
            self.corners.push(hit);
        }
    }

    /// The distance of a point from the line through two corners, m; positive on the side of the body.
    fn depth_m(&self, from: &Point2<f64>, to: &Point2<f64>, point: &Point2<f64>) -> f64 {
        let along = to - from;
        self.side * along.perp(&(point - from)) / along.norm().max(1e-9)
    }

    /// The hit that is deepest behind the outline, and its depth, m.
    fn deepest(&self, hits: &[Point2<f64>]) -> (usize, f64) {
        let (mut corner, mut deepest) = (0, (0, 0.0));
        for (number, hit) in hits.iter().enumerate() {
            if corner + 2 < self.corners.len() && *hit == self.corners[corner + 1] {
                corner += 1;
            }
            let depth_m = self.depth_m(&self.corners[corner], &self.corners[corner + 1], hit);
            if depth_m > deepest.1 {
                deepest = (number, depth_m);
            }
        }
        deepest
    }

    /// The point turned by 180° about the middle of the body.
    fn turned(&self, point: &Point2<f64>) -> Point2<f64> {
        self.corners[0] + (self.corners[self.corners.len() - 1] - point)
    }

    /// Whether a point is in the body, or nearer to the visible and to the far side than these distances, m.
    fn reaches(&self, point: &Point2<f64>, [visible_m, far_m]: [f64; 2]) -> bool {
        let turned = self.turned(point);
        self.corners.windows(2).all(|side| {
            self.depth_m(&side[0], &side[1], point) >= -visible_m
                && self.depth_m(&side[0], &side[1], &turned) >= -far_m
        })
    }

    /// The box around the body.
    fn bounds(&self) -> (Point2<f64>, Point2<f64>) {
        let both = |corner: &Point2<f64>| [*corner, self.turned(corner)];
        let box_of = |(low, high): (Point2<f64>, Point2<f64>), at: Point2<f64>| (low.inf(&at), high.sup(&at));
        self.corners.iter().flat_map(both).fold((self.corners[0], self.corners[0]), box_of)
    }
}

impl SurfaceGrid {
    /// Notes the hit of one beam, counted for this cell, if the hit is on a new obstacle or can be on one.
    pub(super) fn note_new(&mut self, beam: usize, index: usize, cells: &CellMap) {
        let surface = &self.surfaces[index];
        match cells.state(index) {
            CellState::Blocked if surface.came => self.new_hits.push((beam, true)),
            CellState::Free if surface.hit_at == cells.reading() => self.new_hits.push((beam, false)),
            _ => {}
        }
    }

    /// Blocks the free cells in the bodies of new obstacles (rule 4).
    pub(super) fn bodies(&mut self, scan: &ProjectedScan, cells: &mut CellMap) {
        let new_hits = std::mem::take(&mut self.new_hits);
        let mut hits = std::mem::take(&mut self.body_hits);
        hits.clear();
        let (mut next, mut is_new) = (usize::MAX, false);
        for &(beam, is_on_new) in &new_hits {
            let Some(end) = self.segmentation.ends[beam] else { continue };
            let is_near = |last: &Point2<f64>| (end - last).norm() < self.settings.max_gap_m;
            if beam != next || !hits.last().is_some_and(is_near) {
                self.body(&hits, is_new, scan, cells);
                hits.clear();
                is_new = false;
            }
            hits.push(end);
            (next, is_new) = (beam + 1, is_new || is_on_new);
        }
        self.body(&hits, is_new, scan, cells);
        (self.new_hits, self.body_hits) = (new_hits, hits);
    }

    /// Blocks the free cells in the body with these hits; in two bodies, if the hits enclose a hollow.
    fn body(&mut self, hits: &[Point2<f64>], is_new: bool, scan: &ProjectedScan, cells: &mut CellMap) {
        if hits.len() < 3 || !is_new {
            return; // Two hits enclose nothing; hits on nothing that is on the map can be noise.
        }
        let mut body = std::mem::take(&mut self.body);
        body.wrap(hits, scan.increment_rad < 0.0);
        let (deepest, depth_m) = body.deepest(hits);
        let SurfaceGridSettings { range_noise_std_m, surface_depth_m, .. } = self.settings;
        let is_hollow = depth_m > surface_depth_m.max(NOISE_STDS * range_noise_std_m);
        if !is_hollow {
            self.block(&body, scan, cells);
        }
        self.body = body;
        if is_hollow && deepest > 0 && deepest + 1 < hits.len() {
            self.body(&hits[..=deepest], is_new, scan, cells);
            self.body(&hits[deepest..], is_new, scan, cells);
        }
    }

    /// Blocks the free cells that a body touches, but for those that a beam passes.
    fn block(&mut self, body: &Body, scan: &ProjectedScan, cells: &mut CellMap) {
        let frame = *cells.frame();
        let reach_m = REACH.map(|share| share * frame.resolution_m());
        // Not beyond the corners either: the lines through two sides meet far from a sharp corner.
        let bounds = body.bounds();
        let around = Vector2::repeat(reach_m[0] - frame.resolution_m() / 2.0);
        let (low, high) = (frame.cell_at(&(bounds.0 - around)), frame.cell_at(&(bounds.1 + around)));
        for y in low.y.max(0)..=high.y.min(frame.height() as i32 - 1) {
            for x in low.x.max(0)..=high.x.min(frame.width() as i32 - 1) {
                let cell = Cell::new(x, y);
                let Some(index) = frame.index(cell).filter(|&index| cells.state(index) == CellState::Free)
                else {
                    continue;
                };
                let center = frame.center(cell);
                let max_gap_m = self.settings.max_gap_m;
                if body.reaches(&center, reach_m) && !passes(scan, &center, 0.0, max_gap_m, reach_m[0]) {
                    let in_view = cells.is_in_view(index);
                    self.surfaces[index] = Surface {
                        hit_at: cells.reading(),
                        evidence: self.settings.misses_to_free_fresh as i8,
                        came: true,
                        ..Surface::default()
                    };
                    self.remember(index, center, cells);
                    cells.set_state(index, CellState::Blocked, cells.reading(), in_view);
                }
            }
        }
    }
}

//! Bodies: the cells inside of a new obstacle, which no beam can show.

use super::{HITS_TO_STAND, MAX_GAP_M, SURFACE_DEPTH_M, Surface, SurfaceGrid};
use crate::change::{CellMap, ReadingIndex};
use crate::occupancy::inverse_sensor_model::{NOISE_STDS, passes};
use crate::occupancy::projection::ProjectedScan;
use interfaces::{Cell, CellState};
use nalgebra::{Point2, Vector2};

/// A body touches a cell if the center of the cell is nearer to the body than half a cell. Noise takes a part of this
/// distance: less at the visible side, more at the far side, which follows from several hits. In cells.
const REACH: [f64; 2] = [0.4, 0.2];
/// A surface is at rest after this many times the hits after which it stands, about 10 s in view.
const REST: u16 = 5;
/// The distance from a hit to the next one on the same surface is at most this many times the distance between the two
/// beams there: a surface that is seen at 20° or more.
const MAX_SPACINGS: f64 = 3.0;

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

/// A hit on a new obstacle, or a hit that can be on one.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewHit {
    beam: usize,
    /// Whether the obstacle is on the map.
    is_on_map: bool,
    /// The reading since which a surface at rest has been there; the last of all readings for other surfaces.
    since: ReadingIndex,
}

impl NewHit {
    fn is_at_rest(&self) -> bool {
        self.since < ReadingIndex::MAX
    }
}

/// What is known of the hits on one body.
#[derive(Clone, Copy, Debug, Default)]
struct Known {
    /// Whether a part of the body is on the map.
    is_on_map: bool,
    /// The reading since which all surfaces have been there, see [`NewHit::since`].
    since: ReadingIndex,
}

impl SurfaceGrid {
    /// Notes the hit of one beam, counted for this cell, if the hit is on a new obstacle or can be on one.
    pub(super) fn note_new(&mut self, beam: usize, index: usize, cells: &CellMap) {
        let surface = &self.surfaces[index];
        let is_on_map = match cells.state(index) {
            CellState::Blocked if surface.came => true,
            CellState::Free if surface.hit_at == cells.reading() => false,
            _ => return,
        };
        let is_at_rest = is_on_map && surface.hits >= HITS_TO_STAND * REST;
        let since = if is_at_rest { surface.doubted_since } else { ReadingIndex::MAX };
        self.new_hits.push(NewHit { beam, is_on_map, since });
    }

    /// Blocks the free cells in the bodies of new obstacles (rule 4).
    pub(super) fn bodies(&mut self, scan: &ProjectedScan, cells: &mut CellMap) {
        let new_hits = std::mem::take(&mut self.new_hits);
        let mut hits = std::mem::take(&mut self.body_hits);
        hits.clear();
        let (mut known, mut before): (Known, Option<NewHit>) = Default::default();
        for &hit in &new_hits {
            let Some(end) = self.segmentation.ends[hit.beam] else { continue };
            let goes_on = before.zip(hits.last()).is_some_and(|(last, last_end)| {
                // A thing that comes near another one at rest is a body of its own.
                let may_be_other = last.is_at_rest() != hit.is_at_rest();
                let max_m = if may_be_other { self.same_surface_m(hit.beam, scan) } else { f64::INFINITY };
                last.beam + 1 == hit.beam && (end - last_end).norm() < max_m.min(MAX_GAP_M)
            });
            if !goes_on {
                self.body(&hits, known, scan, cells);
                hits.clear();
                known = Known::default();
            }
            hits.push(end);
            known.is_on_map |= hit.is_on_map;
            known.since = known.since.max(hit.since);
            before = Some(hit);
        }
        self.body(&hits, known, scan, cells);
        (self.new_hits, self.body_hits) = (new_hits, hits);
    }

    /// The greatest distance from the hit of a beam to the next hit on the same surface, m.
    fn same_surface_m(&self, beam: usize, scan: &ProjectedScan) -> f64 {
        let spacing_m = scan.spacing_rad * scan.returns[beam].clear_m();
        (MAX_SPACINGS * spacing_m).max(NOISE_STDS * self.settings.range_noise_std_m)
    }

    /// Blocks the free cells in the body with these hits; in two bodies, if the hits enclose a hollow.
    fn body(&mut self, hits: &[Point2<f64>], known: Known, scan: &ProjectedScan, cells: &mut CellMap) {
        if hits.len() < 3 || !known.is_on_map {
            return; // Two hits enclose nothing; hits on nothing that is on the map can be noise.
        }
        let mut body = std::mem::take(&mut self.body);
        body.wrap(hits, scan.increment_rad < 0.0);
        let (deepest, depth_m) = body.deepest(hits);
        let is_hollow = depth_m > SURFACE_DEPTH_M.max(NOISE_STDS * self.settings.range_noise_std_m);
        if !is_hollow {
            self.block(&body, known.since, scan, cells);
        }
        self.body = body;
        if is_hollow && deepest > 0 && deepest + 1 < hits.len() {
            self.body(&hits[..=deepest], known, scan, cells);
            self.body(&hits[deepest..], known, scan, cells);
        }
    }

    /// Blocks the free cells that a body touches, but for those that a beam passes, or that were seen free since all
    /// surfaces of the body have been there: they lie between two bodies.
    fn block(&mut self, body: &Body, since: ReadingIndex, scan: &ProjectedScan, cells: &mut CellMap) {
        let frame = *cells.frame();
        let reach_m = REACH.map(|share| share * frame.resolution_m());
        // Not beyond the corners either: the lines through two sides meet far from a sharp corner.
        let bounds = body.bounds();
        let around = Vector2::repeat(reach_m[0] - frame.resolution_m() / 2.0);
        let (low, high) = (frame.cell_at(&(bounds.0 - around)), frame.cell_at(&(bounds.1 + around)));
        for y in low.y.max(0)..=high.y.min(frame.height() as i32 - 1) {
            for x in low.x.max(0)..=high.x.min(frame.width() as i32 - 1) {
                let cell = Cell::new(x, y);
                let may_be_inside = |index: &usize| {
                    cells.state(*index) == CellState::Free && !cells.was_seen_after(*index, since)
                };
                let Some(index) = frame.index(cell).filter(may_be_inside) else { continue };
                let center = frame.center(cell);
                if body.reaches(&center, reach_m) && !passes(scan, &center, 0.0, MAX_GAP_M, reach_m[0]) {
                    let in_view = cells.is_in_view(index);
                    self.surfaces[index] = Surface {
                        hit_at: cells.reading(),
                        came: true,
                        doubted_since: cells.reading(),
                        ..Surface::default()
                    };
                    self.evidence[index] = self.settings.misses_to_free_fresh as i8;
                    self.remember(index, center, cells);
                    cells.set_state(index, CellState::Blocked, cells.reading(), in_view);
                }
            }
        }
    }
}

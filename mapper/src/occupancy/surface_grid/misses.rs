//! Misses: the evidence that a cell is free.

use super::{
    MAX_GAP_M, MISSES_TO_DISCOVER, MISSES_TO_DISCOVER_BESIDE, SURFACE_DEPTH_M, Surface, SurfaceGrid,
};
use crate::change::CellMap;
use crate::occupancy::footprint::beyond_fan;
use crate::occupancy::inverse_sensor_model::passes;
use crate::occupancy::projection::ProjectedScan;
use interfaces::{CellState, GridFrame};
use nalgebra::{Point2, Vector2};

/// A free cell that was passed only in part is tried again after this number of scans.
const MISSES_TO_PASS: i8 = 16;
/// The part of a cell's side that must be passed: in the rest is the noise of the walls beside.
const WHOLE: f64 = 0.8;
/// A surface is the other face of a thin wall up to this distance along it, m: less than a doorway.
const BESIDE_M: f64 = 0.5;

impl SurfaceGrid {
    /// Counts the cells that the beams passed (rule 2).
    pub(super) fn misses(&mut self, scan: &ProjectedScan, cells: &mut CellMap) {
        let frame = *cells.frame();
        let joined = &self.segmentation.joined;
        let mut unsettled = std::mem::take(&mut self.unsettled);
        unsettled.clear();
        self.footprint.fill(
            scan,
            &frame,
            MAX_GAP_M,
            |beam| joined[beam],
            |start, end| cells.observe_run(start, end, &mut unsettled),
        );
        beyond_fan(scan, &frame, MAX_GAP_M, |index| {
            cells.observe_run(index, index + 1, &mut unsettled);
        });
        // A cell that was hit receives no miss. A miss changes nothing else in a settled cell without a surface. In a loop of its
        // own for the reason of `CellMap::load`.
        let now = cells.reading();
        unsettled.retain(|&index| {
            let index = index as usize;
            let is_done = self.surfaces.is_none(index) && cells.observe_settled(index);
            !is_done && self.surfaces[index].hit_at != now
        });
        cells.load(unsettled.iter().map(|&index| index as usize));
        for &index in &unsettled {
            self.miss(index as usize, scan, cells);
        }
        self.unsettled = unsettled;
    }

    fn miss(&mut self, index: usize, scan: &ProjectedScan, cells: &mut CellMap) {
        let now = cells.reading();
        match cells.state(index) {
            CellState::Free => {
                cells.observe(index);
                let evidence = match self.evidence[index] {
                    0 => 0,
                    1 if self.surfaces[index].partly_free => -1,
                    hits if hits > 0 => hits - 1,
                    misses if misses > -MISSES_TO_PASS => misses - 1,
                    _ => self.free_evidence(index, scan, cells.frame()),
                };
                self.evidence.set(index, evidence);
                if let Some(surface) = self.surfaces.stored_mut(index) {
                    surface.hits = evidence.max(0) as u16;
                }
                cells.set_settled(index, evidence == 0);
            }
            CellState::Unknown if self.surfaces[index].surface_at != now => {
                let misses = if self.is_beside_surface(index, cells.frame()) {
                    MISSES_TO_DISCOVER_BESIDE
                } else {
                    MISSES_TO_DISCOVER
                };
                let evidence = &mut self.evidence[index];
                *evidence = (*evidence).min(0) - 1;
                if *evidence <= -misses {
                    let evidence = self.free_evidence(index, scan, cells.frame());
                    self.evidence.set(index, evidence);
                    cells.set_settled(index, evidence == 0);
                    cells.set_state(index, CellState::Free, now, false);
                }
            }
            CellState::Blocked if self.is_passed(index, scan, cells.frame()) => {
                let in_view = cells.is_in_view(index);
                cells.observe(index);
                let surface = &mut self.surfaces[index];
                if surface.doubted_since <= surface.hit_at {
                    (surface.doubted_since, surface.doubted_in_view) = (now, in_view);
                }
                let evidence = &mut self.evidence[index];
                *evidence -= 1;
                if *evidence <= 0 {
                    *evidence = 0;
                    let Surface { doubted_since, doubted_in_view, .. } = std::mem::take(surface);
                    cells.set_settled(index, true);
                    if self.is_unconfirmed(index, cells) {
                        cells.correct(index, CellState::Free);
                    } else {
                        cells.set_state(index, CellState::Free, doubted_since, doubted_in_view);
                    }
                }
            }
            CellState::Unknown | CellState::Blocked => {}
        }
    }

    fn is_beside_surface(&self, index: usize, frame: &GridFrame) -> bool {
        let neighbours = frame.cell(index).neighbours8();
        neighbours.into_iter().filter_map(|near| frame.index(near)).any(|near| self.surfaces[near].hits > 0)
    }

    /// The evidence of a free cell without hits: 0 if the scan passes all of it, else −1.
    fn free_evidence(&self, index: usize, scan: &ProjectedScan, frame: &GridFrame) -> i8 {
        let (center, reach_m) = (frame.center(frame.cell(index)), WHOLE * frame.resolution_m() / 2.0);
        let mut corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].into_iter();
        let passes = |corner: Point2<f64>| passes(scan, &corner, 0.0, frame.resolution_m(), SURFACE_DEPTH_M);
        -i8::from(!corners.all(|(x, y)| passes(center + reach_m * Vector2::new(x, y))))
    }

    /// Whether the scan passes through the surface in a blocked cell.
    fn is_passed(&self, index: usize, scan: &ProjectedScan, frame: &GridFrame) -> bool {
        let [x, y] = self.surfaces[index].point_m;
        let surface = frame.origin() + Vector2::new(f64::from(x), f64::from(y));
        let margin_m = SURFACE_DEPTH_M.max(2.0 * self.settings.range_noise_std_m);
        // Between two beams can be the end of a thin wall, but hardly a thing that was seen to come.
        let gap_m = if self.surfaces[index].came { MAX_GAP_M } else { frame.resolution_m() };
        passes(scan, &surface, margin_m, gap_m, SURFACE_DEPTH_M)
            && !self.is_other_face(index, &surface, margin_m + self.settings.range_noise_std_m, scan)
    }

    /// Whether the scan sees the other face of a thin wall, nearer to the point on this face than `across_m`: a beam that grazes
    /// it goes far beyond the point, and does not pass it.
    fn is_other_face(&self, index: usize, point: &Point2<f64>, across_m: f64, scan: &ProjectedScan) -> bool {
        let Some((left, right)) = scan.enclosing(point) else { return false };
        let [x, y] = self.surfaces[index].facing.map(f64::from);
        [left, right].into_iter().any(|beam| {
            self.segmentation.ends[beam].is_some_and(|end| {
                let (to, normal) = (end - point, self.segmentation.normal(beam, &end, scan));
                normal.is_some_and(|normal| {
                    x * normal.x + y * normal.y < 0.0
                        && to.norm() < BESIDE_M
                        && normal.dot(&to).abs() < across_m
                })
            })
        })
    }
}

//! Hits: the evidence that a cell is blocked.

use super::{HITS_TO_BLOCK, HITS_TO_STAND, SURFACE_DEPTH_M, SURFACE_MEMORY, Surface, SurfaceGrid};
use crate::change::CellMap;
use crate::occupancy::footprint::cells_along;
use crate::occupancy::inverse_sensor_model::{NOISE_STDS, hit_point};
use crate::occupancy::projection::ProjectedScan;
use interfaces::{Cell, CellState};
use nalgebra::{Point2, Vector2};

/// A hit farther than this from every standing surface, m, counts as a hit on a new obstacle.
const OPEN_M: f64 = 0.1;
/// A surface of a cell that was never free is permanent after the hits of this time, s, where scans are rare: in a log with a
/// scan per meter, few cells are hit as often as the settings ask for.
const STAND_S: f64 = 4.0;

impl SurfaceGrid {
    /// Finds for each beam the cell right behind its hit, and loads what [`hit`](Self::hit) reads of the cell, for the reason
    /// of [`CellMap::load`].
    pub(super) fn find_ahead(&mut self, scan: &ProjectedScan, cells: &CellMap) {
        let frame = cells.frame();
        let depth_m = SURFACE_DEPTH_M / 4.0;
        let ends = self.segmentation.ends.iter().zip(&scan.directions);
        let ahead = ends.map(|(end, direction)| {
            let index = frame.index(frame.cell_at(&((*end)? + direction * depth_m)));
            index.filter(|index| cells.covers(*index))
        });
        self.ahead.clear();
        self.ahead.extend(ahead);
        let found = || self.ahead.iter().flatten().copied();
        cells.load(found());
        std::hint::black_box(found().fold(0, |loaded, index| loaded ^ self.surfaces[index].hits));
    }

    /// Counts the hit of one beam (rules 1 and 3).
    pub(super) fn hit(&mut self, beam: usize, scan: &ProjectedScan, cells: &mut CellMap) {
        let Some(end) = self.segmentation.ends[beam] else { return };
        let frame = *cells.frame();
        let index_at = |point: Point2<f64>, cells: &CellMap| {
            frame.index(frame.cell_at(&point)).filter(|index| cells.covers(*index))
        };
        // Most beams end on known walls: in a cell with a settled surface, or right before it. Then no normal is
        // needed.
        let ahead = end + scan.directions[beam] * (SURFACE_DEPTH_M / 4.0);
        if let Some(index) = self.ahead[beam].filter(|&index| self.has_settled(index, cells)) {
            self.support(index, None, cells);
            self.note_new(beam, index, cells);
            if self.segmentation.joined[beam] {
                self.support_between(beam, ahead, scan, cells);
            }
            return;
        }
        let normal = self.segmentation.normal(beam, &end, scan);
        let point = hit_point(beam, &end, SURFACE_DEPTH_M, normal, &self.segmentation, scan);
        // A surface in a cell is an observation of the cell, even if the hit counts for the cell behind: a cell
        // that an obstacle enters stays in view.
        if let Some(index) = index_at(end, cells).filter(|&index| cells.state(index) != CellState::Unknown) {
            cells.observe(index);
        }
        let Some(index) = index_at(point, cells) else { return };
        if cells.state(index) == CellState::Blocked {
            self.support(index, Some(point), cells);
        } else {
            self.hit_open(index, &end, point, cells);
        }
        self.face(index, normal);
        self.note_new(beam, index, cells);
        if self.segmentation.joined[beam] {
            self.support_between(beam, point, scan, cells);
        }
    }

    /// Whether a cell holds a standing surface whose position no longer changes with further hits.
    fn has_settled(&self, index: usize, cells: &CellMap) -> bool {
        self.surfaces[index].hits >= HITS_TO_STAND.max(2 * SURFACE_MEMORY)
            && cells.state(index) == CellState::Blocked
    }

    /// Counts a hit for a cell that is not blocked.
    fn hit_open(&mut self, index: usize, end: &Point2<f64>, point: Point2<f64>, cells: &mut CellMap) {
        let noise_m = NOISE_STDS * self.settings.range_noise_std_m;
        let is_free = cells.state(index) == CellState::Free;
        let frame = *cells.frame();
        let is_inside = |point: Point2<f64>| frame.index(frame.cell_at(&point)) == Some(index);
        // An unknown cell near a blocked one takes more hits. Noise that is larger than a cell must not delay the cells
        // that are farther along the same wall: for an unknown cell, at most one cell away is near.
        let reach_m = if is_free { noise_m } else { noise_m.min(frame.resolution_m()) };
        let near = self.surface_near(end, reach_m, is_free, cells);
        if let Some(near) = near {
            self.support(near, None, cells);
        }
        let hits_to_block = match near {
            // A free cell beside a standing surface stays free. An unknown cell can be part of the
            // surface, but that takes more hits.
            Some(_) if is_free => return,
            Some(_) => few_hits_to_stand(cells),
            // Far from known surfaces one hit is enough, unless noise could put the hit into this cell.
            None if is_free
                && self.surface_near(end, OPEN_M, true, cells).is_none()
                && is_inside(end + (point - end).normalize() * noise_m) =>
            {
                u16::from(self.settings.hits_to_block_in_open)
            }
            None => HITS_TO_BLOCK,
        };
        self.add_hit(index, point, hits_to_block, cells);
    }

    /// The nearest of the blocked cells within `reach_m` along both axes, `is_permanent`: of those with a permanent surface.
    /// Within the noise, the surface that the hit comes from (rule 3).
    fn surface_near(
        &self,
        end: &Point2<f64>,
        reach_m: f64,
        is_permanent: bool,
        cells: &CellMap,
    ) -> Option<usize> {
        let (frame, few_hits) = (cells.frame(), few_hits_to_stand(cells));
        let counts = |surface: &Surface| {
            let hits_to_stand = if surface.came { HITS_TO_STAND } else { few_hits };
            !is_permanent || surface.hits >= hits_to_stand
        };
        let reach = Vector2::repeat(reach_m);
        let (low, high) = (frame.cell_at(&(end - reach)), frame.cell_at(&(end + reach)));
        let near = (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| Cell::new(x, y)));
        near.filter_map(|cell| {
            let index = frame.index(cell)?;
            let is_near = cells.state(index) == CellState::Blocked && counts(&self.surfaces[index]);
            is_near.then(|| ((frame.center(cell) - end).norm_squared(), index))
        })
        .min_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, index)| index)
    }

    /// A blocked cell was hit, or lies on a surface that was hit.
    fn support(&mut self, index: usize, point: Option<Point2<f64>>, cells: &mut CellMap) {
        let now = cells.reading();
        let surface = &mut self.surfaces[index];
        if surface.hit_at != now {
            surface.hit_at = now;
            surface.hits = surface.hits.saturating_add(1);
            self.evidence[index] = self.settings.misses_to_free_after(surface.hits);
            cells.observe(index);
        }
        if let Some(point) = point {
            self.remember(index, point, cells);
        }
    }

    /// The cells between this hit and the next hit on the same surface are on the surface, too: the blocked ones
    /// stay blocked, and no beam passes them.
    fn support_between(&mut self, beam: usize, from: Point2<f64>, scan: &ProjectedScan, cells: &mut CellMap) {
        let frame = *cells.frame();
        let ends = &self.segmentation.ends;
        let (Some(end), Some(next)) = (ends[beam], scan.next(beam)) else { return };
        let Some(next) = ends[next] else { return };
        let to = from + (next - end);
        let (first, last) = (frame.cell_at(&from), frame.cell_at(&to));
        if first.x.abs_diff(last.x) + first.y.abs_diff(last.y) <= 1 {
            return; // The two hits cover the cells between them.
        }
        cells_along(&frame, &from, &to, |index| match cells.state(index) {
            CellState::Blocked => self.support(index, None, cells),
            CellState::Unknown if !cells.covers(index) => {}
            CellState::Unknown => self.surfaces[index].surface_at = cells.reading(),
            CellState::Free => cells.observe(index),
        });
    }

    /// A hit in a cell that is not blocked; `hits_to_block` hits block the cell.
    fn add_hit(&mut self, index: usize, point: Point2<f64>, hits_to_block: u16, cells: &mut CellMap) {
        let now = cells.reading();
        if self.surfaces[index].hit_at != now {
            let in_view = cells.is_in_view(index);
            let surface = &mut self.surfaces[index];
            surface.hit_at = now;
            let evidence = &mut self.evidence[index];
            if *evidence <= 0 {
                surface.partly_free = *evidence < 0 && cells.state(index) == CellState::Free;
                *evidence = 0;
                (surface.doubted_since, surface.doubted_in_view) = (now, in_view);
                if cells.state(index) == CellState::Free {
                    surface.hits = 0; // In an unknown cell hits accumulate, with or without misses between them.
                }
            }
            *evidence += 1;
            surface.hits = surface.hits.saturating_add(1);
            cells.set_settled(index, false);
            if cells.state(index) == CellState::Free {
                cells.observe(index);
            }
        }
        self.remember(index, point, cells);
        if self.surfaces[index].hits >= hits_to_block {
            self.evidence[index] = self.settings.misses_to_free_fresh as i8;
            let is_wrong = self.is_unconfirmed(index, cells);
            let surface = &mut self.surfaces[index];
            if is_wrong {
                cells.correct(index, CellState::Blocked);
            } else {
                surface.came = cells.state(index) == CellState::Free;
                cells.set_state(index, CellState::Blocked, surface.doubted_since, surface.doubted_in_view);
            }
        }
    }

    /// Remembers to which side the surface of a cell looks: to none if it has two faces.
    fn face(&mut self, index: usize, normal: Option<Vector2<f64>>) {
        let surface = self.surfaces.stored_mut(index).filter(|surface| surface.hits > 0);
        let (Some(normal), Some(surface)) = (normal, surface) else { return };
        let [x, y] = surface.facing.map(f64::from);
        if surface.hits == 1 {
            surface.facing = [normal.x, normal.y].map(|side| (side * 100.0) as i8);
        } else if x * normal.x + y * normal.y < 0.0 {
            surface.facing = [0; 2];
        }
    }

    /// Moves the remembered surface point toward a hit.
    pub(super) fn remember(&mut self, index: usize, point: Point2<f64>, cells: &CellMap) {
        let surface = &mut self.surfaces[index];
        let at = point - cells.frame().origin();
        let weight = 1.0 / f32::from(surface.hits.clamp(1, SURFACE_MEMORY));
        for (mean, at) in surface.point_m.iter_mut().zip([at.x as f32, at.y as f32]) {
            *mean += (at - *mean) * weight;
        }
    }
}

/// The number of hits after which the surface of a cell that was never free is permanent.
fn few_hits_to_stand(cells: &CellMap) -> u16 {
    let hits = (STAND_S / cells.period()).ceil().max(f64::from(HITS_TO_BLOCK));
    HITS_TO_STAND.min(hits as u16)
}

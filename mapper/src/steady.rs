//! Occupancy without flicker.
//!
//! What makes a static wall look as if it changed is the grazing beam: it crosses the cells of a
//! surface that steeper beams hit, many scans in a row. Counting hits and misses cannot tell that
//! from a thing that went. Four rules can, because they remember *where in the cell* the surface
//! is:
//!
//! 1. **A hit belongs behind the surface.** Surfaces lie on the borders of cells; the hit counts
//!    for the cell a little behind it, along the surface's normal.
//! 2. **A cell is cleared through its surface.** Each blocked cell keeps the mean of the points
//!    that were hit. A scan contradicts it only when *both* beams that enclose this point pass
//!    beyond it. The point lies inside of the body, so next to a standing body one of the two
//!    always ends before it, however flat they come in.
//! 3. **Noise belongs to the surface it comes from.** A hit within four standard deviations of a
//!    standing surface is a hit on that surface, not something new beside it.
//!
//! 4. **A thing that comes has a body.** What it hides at once is blocked too, a little way behind
//!    its surface.
//!
//! A hit beats a miss: a cell that was hit takes no miss from the same scan. And a first sighting
//! from afar can be wrong: what is overturned before it was confirmed is corrected, not a change.

use crate::SteadySettings;
use crate::footprint::{Footprint, beyond_fan, cells_along};
use crate::ledger::{Ledger, ReadingIndex};
use crate::outline::Outline;
use crate::projection::PointCloud;
use interfaces::{Cell, CellState, GridFrame};
use nalgebra::{Point2, Vector2};

/// Range noise stays within so many standard deviations. At three, one hit in 700 would not, and a
/// wall takes a hundred hits per scan.
const NOISE_STDS: f64 = 4.0;
/// A hit farther than this from every standing surface, m, is in the open: something came.
const OPEN_M: f64 = 0.1;
/// The mean of the points hit forgets at this pace, in hits.
const SURFACE_MEMORY: u16 = 32;

/// What a cell remembers of the hits in it.
#[derive(Clone, Copy, Debug, Default)]
struct Surface {
    /// The mean of the points that were hit, relative to the lower left corner of the grid, m.
    point_m: [f32; 2],
    /// Scans with a hit in this cell since it was last free.
    hits: u16,
    /// Of an unknown or free cell: hits (above 0) or misses (below) in a row. Of a blocked cell:
    /// the misses it still takes.
    evidence: i8,
    /// The reading of the last hit.
    hit_at: ReadingIndex,
    /// The last reading in which a surface between two hits went through the cell.
    surface_at: ReadingIndex,
    /// Whether the cell was free before: the surface is that of a thing that came.
    came: bool,
    /// When the evidence against the present state began, and whether the cell was in view then.
    doubted_since: ReadingIndex,
    doubted_in_view: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct Steady {
    settings: SteadySettings,
    surfaces: Vec<Surface>,
    footprint: Footprint,
    outline: Outline,
    /// Scratch: the cells of a scan that need a closer look.
    doubtful: Vec<u32>,
}

impl Steady {
    pub(crate) fn new(settings: SteadySettings, ledger: &mut Ledger) -> Self {
        for index in 0..ledger.frame().len() {
            ledger.set_settled(index, ledger.state(index) == CellState::Free);
        }
        let frame = ledger.frame();
        let surface = |(index, &state): (usize, &CellState)| match state {
            CellState::Blocked => {
                let middle = frame.center(frame.cell(index)) - frame.origin();
                Surface {
                    point_m: [middle.x as f32, middle.y as f32],
                    hits: settings.hits_to_stand,
                    evidence: settings.misses_to_free as i8,
                    ..Surface::default()
                }
            }
            _ => Surface::default(),
        };
        let states = ledger.states().cells();
        Self {
            surfaces: states.iter().enumerate().map(surface).collect(),
            settings,
            footprint: Footprint::default(),
            outline: Outline::default(),
            doubtful: Vec::new(),
        }
    }

    pub(crate) fn update(&mut self, cloud: &PointCloud, ledger: &mut Ledger) {
        self.outline.trace(cloud, self.settings.join_m);
        for beam in 0..cloud.len() {
            self.hit(beam, cloud, ledger);
        }
        self.see_through(cloud, ledger);
    }

    /// Counts one beam's hit (rules 1 and 3).
    fn hit(&mut self, beam: usize, cloud: &PointCloud, ledger: &mut Ledger) {
        let Some(end) = self.outline.ends[beam] else { return };
        let frame = *ledger.frame();
        let place = |point: Point2<f64>| frame.index(frame.cell_at(&point));
        // Most beams end on walls that are long known. Where the beam ends in a cell whose surface has
        // settled, or right before it, the normal has nothing to add.
        let ahead = end + cloud.directions[beam] * (self.settings.surface_depth_m / 4.0);
        if let Some(index) = place(ahead).filter(|&index| self.has_settled(index, ledger)) {
            self.support(index, None, ledger);
            if self.outline.joined[beam] {
                self.support_between(beam, ahead, cloud, ledger);
            }
            return;
        }
        let point = self.outline.behind(beam, &end, self.settings.surface_depth_m, cloud);
        // A surface in a cell is a sight of it, even where the hit counts for the cell behind: a cell
        // that something moves into stays in view.
        if let Some(index) = place(end).filter(|&index| ledger.state(index) != CellState::Unknown) {
            ledger.see(index);
        }
        let Some(index) = place(point) else { return };
        if ledger.state(index) == CellState::Blocked {
            self.support(index, Some(point), ledger);
        } else {
            self.hit_open(index, &end, point, ledger);
        }
        let has_come = self.surfaces[index].came && self.surfaces[index].hits < self.settings.hits_to_stand;
        if has_come && !self.outline.is_edge(beam) {
            self.fill_body(&end, &point, ledger);
        }
        if self.outline.joined[beam] {
            self.support_between(beam, point, cloud, ledger);
        }
    }

    /// Whether a cell holds a standing surface that further hits would hardly move.
    fn has_settled(&self, index: usize, ledger: &Ledger) -> bool {
        let settled = self.settings.hits_to_stand.max(2 * SURFACE_MEMORY);
        self.surfaces[index].hits >= settled && ledger.state(index) == CellState::Blocked
    }

    /// Counts a hit for a cell that is not blocked.
    fn hit_open(&mut self, index: usize, end: &Point2<f64>, point: Point2<f64>, ledger: &mut Ledger) {
        let SteadySettings { hits_to_stand, hits_to_block, hits_to_block_in_open, .. } = self.settings;
        let noise_m = NOISE_STDS * self.settings.range_noise_std_m;
        let is_free = ledger.state(index) == CellState::Free;
        let frame = *ledger.frame();
        let is_inside = |point: Point2<f64>| frame.index(frame.cell_at(&point)) == Some(index);
        let near = self.surface_near(end, noise_m, if is_free { hits_to_stand } else { 0 }, ledger);
        if let Some(near) = near {
            self.support(near, None, ledger);
        }
        let hits_to_block = match near {
            // A free cell beside a standing surface stays so. An unknown one can be part of the
            // surface, but it takes more hits to say so.
            Some(_) if is_free => return,
            Some(_) => hits_to_stand,
            // In the open one hit is enough, unless it is noise that puts it into this cell.
            None if is_free
                && self.surface_near(end, OPEN_M, hits_to_stand, ledger).is_none()
                && is_inside(end + (point - end).normalize() * noise_m) =>
            {
                u16::from(hits_to_block_in_open)
            }
            None => u16::from(hits_to_block),
        };
        self.add_hit(index, point, hits_to_block, ledger);
    }

    /// Of the blocked cells with `min_hits` that lie within `reach_m` along both axes, the nearest:
    /// within the noise, the surface that the hit comes from (rule 3).
    fn surface_near(&self, end: &Point2<f64>, reach_m: f64, min_hits: u16, ledger: &Ledger) -> Option<usize> {
        let frame = ledger.frame();
        let reach = Vector2::repeat(reach_m);
        let (low, high) = (frame.cell_at(&(end - reach)), frame.cell_at(&(end + reach)));
        let cells = (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| Cell::new(x, y)));
        cells
            .filter_map(|cell| {
                let index = frame.index(cell)?;
                let stands =
                    ledger.state(index) == CellState::Blocked && self.surfaces[index].hits >= min_hits;
                stands.then(|| ((frame.center(cell) - end).norm_squared(), index))
            })
            .min_by(|(a, _), (b, _)| a.total_cmp(b))
            .map(|(_, index)| index)
    }

    /// What came into the open has a body (rule 4): the free cells behind a hit on it are blocked, as
    /// deep as things are thick. They are hidden now, and nothing else would tell.
    fn fill_body(&mut self, end: &Point2<f64>, point: &Point2<f64>, ledger: &mut Ledger) {
        let frame = *ledger.frame();
        let Some(inward) = (point - end).try_normalize(1e-9) else { return };
        let layers = (self.settings.body_m / frame.resolution_m() + 1e-6) as usize;
        for layer in 1..=layers {
            let inside = point + inward * (layer as f64 * frame.resolution_m());
            let Some(index) = frame.index(frame.cell_at(&inside)) else { return };
            if ledger.state(index) == CellState::Free && !ledger.was_seen_now(index) {
                let in_view = ledger.is_in_view(index);
                self.surfaces[index] = Surface {
                    hit_at: ledger.now_index(),
                    evidence: self.settings.misses_to_free_fresh as i8,
                    ..Surface::default()
                };
                self.remember(index, inside, ledger);
                ledger.turn(index, CellState::Blocked, ledger.now_index(), in_view);
            }
        }
    }

    /// A blocked cell was hit, or lies on a surface that was.
    fn support(&mut self, index: usize, point: Option<Point2<f64>>, ledger: &mut Ledger) {
        let now = ledger.now_index();
        let surface = &mut self.surfaces[index];
        if surface.hit_at != now {
            surface.hit_at = now;
            surface.hits = surface.hits.saturating_add(1);
            surface.evidence = self.settings.misses_to_free_after(surface.hits);
            ledger.see(index);
        }
        if let Some(point) = point {
            self.remember(index, point, ledger);
        }
    }

    /// The cells between this hit and its joined neighbour lie on the surface too: the blocked ones
    /// stand, and none of them is seen through.
    fn support_between(&mut self, beam: usize, from: Point2<f64>, cloud: &PointCloud, ledger: &mut Ledger) {
        let frame = *ledger.frame();
        let ends = &self.outline.ends;
        let (Some(end), Some(next)) = (ends[beam], cloud.next(beam)) else { return };
        let Some(next) = ends[next] else { return };
        let to = from + (next - end);
        let (first, last) = (frame.cell_at(&from), frame.cell_at(&to));
        if first.x.abs_diff(last.x) + first.y.abs_diff(last.y) <= 1 {
            return; // the two hits cover the cells between them
        }
        cells_along(&frame, &from, &to, |index| match ledger.state(index) {
            CellState::Blocked => self.support(index, None, ledger),
            CellState::Unknown => self.surfaces[index].surface_at = ledger.now_index(),
            CellState::Free => ledger.see(index),
        });
    }

    /// A hit in a cell that is not blocked; at `hits_to_block` of them it is.
    fn add_hit(&mut self, index: usize, point: Point2<f64>, hits_to_block: u16, ledger: &mut Ledger) {
        let now = ledger.now_index();
        if self.surfaces[index].hit_at != now {
            let in_view = ledger.is_in_view(index);
            let surface = &mut self.surfaces[index];
            surface.hit_at = now;
            if surface.evidence <= 0 {
                surface.evidence = 0;
                (surface.doubted_since, surface.doubted_in_view) = (now, in_view);
                if ledger.state(index) == CellState::Free {
                    surface.hits = 0; // in an unknown cell hits add up, with or without misses between
                }
            }
            surface.evidence += 1;
            surface.hits = surface.hits.saturating_add(1);
            ledger.set_settled(index, false);
            if ledger.state(index) == CellState::Free {
                ledger.see(index);
            }
        }
        self.remember(index, point, ledger);
        let surface = &mut self.surfaces[index];
        if surface.hits >= hits_to_block {
            surface.evidence = self.settings.misses_to_free_fresh as i8;
            if ledger.is_unconfirmed(index, self.settings.confirm_s) {
                ledger.correct(index, CellState::Blocked);
            } else {
                surface.came = ledger.state(index) == CellState::Free;
                ledger.turn(index, CellState::Blocked, surface.doubted_since, surface.doubted_in_view);
            }
        }
    }

    /// Moves the remembered surface point towards a hit.
    fn remember(&mut self, index: usize, point: Point2<f64>, ledger: &Ledger) {
        let surface = &mut self.surfaces[index];
        let at = point - ledger.frame().origin();
        let weight = 1.0 / f32::from(surface.hits.clamp(1, SURFACE_MEMORY));
        for (mean, at) in surface.point_m.iter_mut().zip([at.x as f32, at.y as f32]) {
            *mean += (at - *mean) * weight;
        }
    }

    /// Counts the cells that the scan saw through (rule 2).
    fn see_through(&mut self, cloud: &PointCloud, ledger: &mut Ledger) {
        let frame = *ledger.frame();
        let joined = &self.outline.joined;
        let mut doubtful = std::mem::take(&mut self.doubtful);
        doubtful.clear();
        self.footprint.fill(
            cloud,
            &frame,
            self.settings.max_gap_m,
            |beam| joined[beam],
            |start, end| ledger.see_run(start, end, &mut doubtful),
        );
        beyond_fan(cloud, &frame, self.settings.max_gap_m, |index| {
            ledger.see_run(index, index + 1, &mut doubtful);
        });
        for &index in &doubtful {
            self.miss(index as usize, cloud, ledger);
        }
        self.doubtful = doubtful;
    }

    fn miss(&mut self, index: usize, cloud: &PointCloud, ledger: &mut Ledger) {
        let now = ledger.now_index();
        if self.surfaces[index].hit_at == now {
            return; // a hit beats a miss
        }
        match ledger.state(index) {
            CellState::Free => {
                ledger.see(index);
                let surface = &mut self.surfaces[index];
                surface.evidence = (surface.evidence - 1).max(0);
                surface.hits = surface.evidence as u16;
                ledger.set_settled(index, surface.evidence == 0);
            }
            CellState::Unknown if self.surfaces[index].surface_at != now => {
                let misses = if self.is_beside_surface(index, ledger.frame()) {
                    self.settings.misses_to_discover_beside
                } else {
                    self.settings.misses_to_discover
                };
                let surface = &mut self.surfaces[index];
                surface.evidence = surface.evidence.min(0) - 1;
                if surface.evidence <= -(misses as i8) {
                    surface.evidence = 0;
                    ledger.set_settled(index, true);
                    ledger.turn(index, CellState::Free, now, false);
                }
            }
            CellState::Blocked if self.is_passed(index, cloud, ledger.frame()) => {
                let in_view = ledger.is_in_view(index);
                ledger.see(index);
                let surface = &mut self.surfaces[index];
                if surface.doubted_since <= surface.hit_at {
                    (surface.doubted_since, surface.doubted_in_view) = (now, in_view);
                }
                surface.evidence -= 1;
                if surface.evidence <= 0 {
                    let Surface { doubted_since, doubted_in_view, .. } = std::mem::take(surface);
                    ledger.set_settled(index, true);
                    if ledger.is_unconfirmed(index, self.settings.confirm_s) {
                        ledger.correct(index, CellState::Free);
                    } else {
                        ledger.turn(index, CellState::Free, doubted_since, doubted_in_view);
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

    /// Whether the scan saw through the surface that a blocked cell holds.
    fn is_passed(&self, index: usize, cloud: &PointCloud, frame: &GridFrame) -> bool {
        let [x, y] = self.surfaces[index].point_m;
        let surface = frame.origin() + Vector2::new(f64::from(x), f64::from(y));
        let distance_m = (surface - cloud.origin).norm();
        let margin_m = self.settings.surface_depth_m.max(2.0 * self.settings.range_noise_std_m);
        let passes = |beam: usize| cloud.returns[beam].clear_m() > distance_m + margin_m;
        let Some((left, right)) = cloud.enclosing(&surface) else { return false };
        if cloud.spacing_rad * distance_m <= self.settings.max_gap_m {
            return passes(left) && passes(right);
        }
        // Sparse beams: something thin can stand between the two. One must go through the point.
        [left, right].into_iter().any(|beam| {
            let off_m = cloud.directions[beam].perp(&(surface - cloud.origin)).abs();
            passes(beam) && off_m <= self.settings.surface_depth_m
        })
    }
}

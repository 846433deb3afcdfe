//! Occupancy without flicker.
//!
//! What makes a static wall look as if it changed is the grazing beam: it crosses the cells of a
//! surface that steeper beams hit, many scans in a row. Counting hits and misses cannot tell that
//! from a thing that went. Three rules can, because they remember *where in the cell* the surface
//! is:
//!
//! 1. **A hit belongs behind the surface.** Surfaces lie on the borders of cells; the hit counts
//!    for the cell a little behind it, along the surface's normal.
//! 2. **A cell is cleared through its surface.** Each blocked cell keeps the mean of the points
//!    that were hit. A scan contradicts it only when *both* beams that enclose this point pass
//!    beyond it. The point lies inside of the body, so next to a standing body one of the two
//!    always ends before it, however flat they come in.
//! 3. **Noise belongs to the surface it comes from.** A hit within three standard deviations of a
//!    standing surface is a hit on that surface, not something new beside it.
//!
//! A hit beats a miss: a cell that was hit takes no miss from the same scan.

use crate::SteadySettings;
use crate::footprint::{Footprint, cells_along};
use crate::ledger::{Ledger, ReadingIndex};
use crate::projection::PointCloud;
use geometry::{Cell, CellState, GridFrame};
use nalgebra::{Point2, Vector2};

/// The surface normal at a hit is taken over neighbours at least this far apart, m, so that range
/// noise does not turn it; never over more beams than this to either side.
const NORMAL_BASE_M: f64 = 0.075;
const NORMAL_BEAMS: usize = 8;
/// A surface whose two sides meet at more than 25° turns a corner.
const CORNER_COS: f64 = 0.9;
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
    /// When the evidence against the present state began, and whether the cell was in view then.
    doubted_since: ReadingIndex,
    doubted_in_view: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct Steady {
    settings: SteadySettings,
    surfaces: Vec<Surface>,
    footprint: Footprint,
    /// Scratch: per beam its end point if it hit, and whether the next beam hit the same surface.
    ends: Vec<Option<Point2<f64>>>,
    joined: Vec<bool>,
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
            ends: Vec::new(),
            joined: Vec::new(),
            doubtful: Vec::new(),
        }
    }

    pub(crate) fn update(&mut self, cloud: &PointCloud, ledger: &mut Ledger) {
        self.join(cloud);
        for beam in 0..cloud.len() {
            self.hit(beam, cloud, ledger);
        }
        self.see_through(cloud, ledger);
    }

    /// Finds the end points, and which neighbours lie on one surface.
    fn join(&mut self, cloud: &PointCloud) {
        self.ends.clear();
        self.ends.extend((0..cloud.len()).map(|beam| cloud.hit(beam)));
        self.joined.clear();
        let limit = self.settings.join_m * self.settings.join_m;
        self.joined.extend((0..cloud.len()).map(|beam| {
            let next = cloud.next(beam).and_then(|next| self.ends[next]);
            matches!((self.ends[beam], next), (Some(a), Some(b)) if (b - a).norm_squared() < limit)
        }));
    }

    /// The normal of the surface at a hit, towards the sensor. Where the surface turns a corner, that
    /// of the straighter side: a normal across the corner would point out of the body.
    fn normal(&self, beam: usize, end: &Point2<f64>, cloud: &PointCloud) -> Vector2<f64> {
        let (after, before) = (self.chord(beam, end, 1), self.chord(beam, end, cloud.len() - 1));
        let along = after.dot(&before);
        let turns = along > 0.0
            || along * along < CORNER_COS * CORNER_COS * after.norm_squared() * before.norm_squared();
        let tangent =
            if turns && self.bend(beam, end, &after, 1) <= self.bend(beam, end, &before, cloud.len() - 1) {
                after
            } else if turns {
                -before
            } else {
                after - before
            };
        let length_m = tangent.norm();
        if length_m < 1e-6 {
            return -cloud.directions[beam];
        }
        let normal = Vector2::new(-tangent.y, tangent.x) / length_m;
        if normal.dot(&cloud.directions[beam]) > 0.0 { -normal } else { normal }
    }

    /// From a hit to the neighbours on its surface, beam by beam: `step` is 1 for the beams after
    /// it, one less than the number of beams for those before it.
    fn neighbours(&self, beam: usize, step: usize) -> impl Iterator<Item = Point2<f64>> {
        let mut at = beam;
        (0..NORMAL_BEAMS).map_while(move |_| {
            let next = (at + step) % self.ends.len();
            let joint = if step == 1 { at } else { next };
            at = next;
            if self.joined[joint] { self.ends[next] } else { None }
        })
    }

    /// The chord from a hit to a neighbour far enough away to tell a direction.
    fn chord(&self, beam: usize, end: &Point2<f64>, step: usize) -> Vector2<f64> {
        let mut chord = Vector2::zeros();
        for point in self.neighbours(beam, step) {
            chord = point - end;
            if chord.norm_squared() > NORMAL_BASE_M * NORMAL_BASE_M {
                break;
            }
        }
        chord
    }

    /// How far the surface bends away from a chord, m; ∞ where there is nothing to tell by.
    fn bend(&self, beam: usize, end: &Point2<f64>, chord: &Vector2<f64>, step: usize) -> f64 {
        let length_m = chord.norm();
        let mut bend_m = f64::INFINITY;
        for point in self.neighbours(beam, step) {
            let along = point - end;
            if along.norm_squared() >= length_m * length_m {
                break;
            }
            let off_m = along.perp(chord).abs() / length_m;
            bend_m = if bend_m.is_finite() { bend_m.max(off_m) } else { off_m };
        }
        bend_m
    }

    /// The point that a hit counts for (rule 1): behind the surface along the normal, or, where a
    /// neighbouring beam can see that point (the normal led out of a corner), along the beam.
    fn behind(
        &self,
        beam: usize,
        end: &Point2<f64>,
        normal: &Vector2<f64>,
        cloud: &PointCloud,
    ) -> Point2<f64> {
        let depth_m = self.settings.surface_depth_m;
        let point = end - normal * depth_m;
        let seen = point - cloud.origin;
        let distance_m = seen.norm();
        // Beams from `beam` to the point's direction; the angle is small.
        let turn = cloud.directions[beam].perp(&seen) / (distance_m * cloud.increment_rad);
        let beams = cloud.len() as i64;
        let sees = |step: i64| {
            let at = (beam as i64 + step).rem_euclid(beams) as usize;
            cloud.returns[at].clear_m() > distance_m + depth_m / 2.0
        };
        let step = libm::floor(turn) as i64;
        if turn.is_finite() && (sees(step) || sees(step + 1)) {
            end + cloud.directions[beam] * (depth_m / 2.0)
        } else {
            point
        }
    }

    /// Counts one beam's hit (rules 1 and 3).
    fn hit(&mut self, beam: usize, cloud: &PointCloud, ledger: &mut Ledger) {
        let Some(end) = self.ends[beam] else { return };
        let frame = *ledger.frame();
        let normal = self.normal(beam, &end, cloud);
        let point = self.behind(beam, &end, &normal, cloud);
        let place = |point: Point2<f64>| frame.index(frame.cell_at(&point));
        let Some(index) = place(point) else { return };
        if ledger.state(index) == CellState::Blocked {
            self.support(index, Some(point), ledger);
        } else {
            let standing = self.standing_near(&end, ledger);
            match standing {
                Some(standing) => self.support(standing, None, ledger),
                None => self.add_hit(index, point, ledger),
            }
        }
        if self.joined[beam] {
            self.support_between(beam, point, cloud, ledger);
        }
    }

    /// The standing surface that a hit can come from by range noise (rule 3): the cell nearest to it
    /// within three standard deviations.
    fn standing_near(&self, end: &Point2<f64>, ledger: &Ledger) -> Option<usize> {
        let frame = ledger.frame();
        let reach_m = Vector2::repeat(3.0 * self.settings.range_noise_std_m);
        let (low, high) = (frame.cell_at(&(end - reach_m)), frame.cell_at(&(end + reach_m)));
        let cells = (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| Cell::new(x, y)));
        cells
            .filter_map(|cell| {
                let index = frame.index(cell)?;
                let stands = ledger.state(index) == CellState::Blocked
                    && self.surfaces[index].hits >= self.settings.hits_to_stand;
                stands.then(|| ((frame.center(cell) - end).norm_squared(), index))
            })
            .min_by(|(a, _), (b, _)| a.total_cmp(b))
            .map(|(_, index)| index)
    }

    /// A blocked cell was hit, or lies on a surface that was.
    fn support(&mut self, index: usize, point: Option<Point2<f64>>, ledger: &mut Ledger) {
        let now = ledger.now_index();
        if let Some(point) = point {
            self.remember(index, point, ledger);
        }
        let surface = &mut self.surfaces[index];
        if surface.hit_at != now {
            surface.hit_at = now;
            surface.hits = surface.hits.saturating_add(1);
            let full = u16::from(self.settings.misses_to_free);
            let fresh = u16::from(self.settings.misses_to_free_fresh);
            surface.evidence = fresh.saturating_add(surface.hits).min(full) as i8;
            ledger.see(index);
        }
    }

    /// The cells between this hit and its joined neighbour lie on the surface too: the blocked ones
    /// stand, and none of them is seen through.
    fn support_between(&mut self, beam: usize, from: Point2<f64>, cloud: &PointCloud, ledger: &mut Ledger) {
        let frame = *ledger.frame();
        let (Some(end), Some(next)) = (self.ends[beam], cloud.next(beam)) else { return };
        let Some(next) = self.ends[next] else { return };
        cells_along(&frame, &from, &(from + (next - end)), |cell| {
            if let Some(index) = frame.index(cell) {
                match ledger.state(index) {
                    CellState::Blocked => self.support(index, None, ledger),
                    CellState::Unknown => self.surfaces[index].surface_at = ledger.now_index(),
                    CellState::Free => {}
                }
            }
        });
    }

    /// A hit in a cell that is not blocked, far from every standing surface.
    fn add_hit(&mut self, index: usize, point: Point2<f64>, ledger: &mut Ledger) {
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
        if surface.hits >= u16::from(self.settings.hits_to_block) {
            surface.evidence = self.settings.misses_to_free_fresh as i8;
            ledger.turn(index, CellState::Blocked, surface.doubted_since, surface.doubted_in_view);
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
        let joined = &self.joined;
        let mut doubtful = std::mem::take(&mut self.doubtful);
        doubtful.clear();
        self.footprint.fill(
            cloud,
            &frame,
            self.settings.max_gap_m,
            |beam, _| joined[beam],
            |start, end| ledger.see_run(start, end, &mut doubtful),
        );
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
                let full = (self.settings.misses_to_free as u16).min(
                    u16::from(self.settings.misses_to_free_fresh).saturating_add(self.surfaces[index].hits),
                );
                let surface = &mut self.surfaces[index];
                if i16::from(surface.evidence) >= full as i16 || surface.doubted_since <= surface.hit_at {
                    (surface.doubted_since, surface.doubted_in_view) = (now, in_view);
                }
                surface.evidence -= 1;
                if surface.evidence <= 0 {
                    let (since, in_view) = (surface.doubted_since, surface.doubted_in_view);
                    *surface = Surface::default();
                    ledger.set_settled(index, true);
                    ledger.turn(index, CellState::Free, since, in_view);
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
        let passes = |beam: usize| cloud.returns[beam].clear_m() > distance_m + self.settings.surface_depth_m;
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

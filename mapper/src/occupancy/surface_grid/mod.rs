//! The default occupancy model (`steady`): occupancy without flicker.
//!
//! A grazing beam crosses the cells of a surface that steeper beams hit, in many consecutive scans. Counts of hits
//! and misses cannot distinguish this from an obstacle that disappeared. The following four rules can, because they
//! store *where in the cell* the surface is:
//!
//! 1. **A hit belongs behind the surface.** Surfaces lie on the borders of cells; the hit counts
//!    for the cell a little behind the surface, along its normal.
//! 2. **A cell is cleared through its surface.** Each blocked cell keeps the mean of the points
//!    that were hit. A scan contradicts the cell only when *both* beams that enclose this point pass
//!    beyond the point. The point lies inside the body, so next to a standing body one of the two beams
//!    always ends before the point, at any angle. A thin wall has two faces: a scan of the face that looks the other way
//!    contradicts nothing, and a surface that was not seen to come is cleared by beams closer than a cell alone.
//! 3. **Noise belongs to the nearest surface.** A hit within four standard deviations of a standing surface is a hit on
//!    that surface, not a new obstacle beside it.
//! 4. **A new obstacle has the body that it shows.** Its visible outline, from one end to the other, is turned by 180°
//!    about the middle between the two ends: between both outlines is the body. This is a part of every convex body
//!    with a center of symmetry, however much of the body is visible: most of a disc, all of a box whose corner is seen,
//!    but only the surface of a door leaf or of a single flat side. The free cells in the body become blocked. All
//!    other hidden cells are not seen, and keep their states. A thing that comes near another one at rest is a body of
//!    its own, and cells that were seen free since a body has been at rest are not in the body.
//!
//! A cell that was hit receives no miss from the same scan. A first observation from far away can be wrong: if a
//! state is contradicted before it was confirmed, the state is corrected, which does not count as a change.

mod bodies;
mod hits;
mod misses;
mod settings;
mod surfaces;

use super::OccupancyModel;
use super::footprint::Footprint;
use super::projection::ProjectedScan;
use super::segmentation::Segmentation;
use crate::change::{CellMap, ReadingIndex};
use crate::{Growth, MapperSettings};
use bodies::{Body, NewHit};
use interfaces::{CellState, SparseCells, Values, cell_runs};
use nalgebra::Point2;
pub use settings::SurfaceGridSettings;
use surfaces::Surfaces;

/// The distance behind the surface, along its normal, at which a hit counts, m: a surface on the border of two cells belongs to
/// the solid cell.
const SURFACE_DEPTH_M: f64 = 0.02;
/// Hits nearer to each other than this, m, belong to one surface: no beam passes the cells between them.
const JOIN_M: f64 = 1.0;
/// Where neighboring beams are farther apart than this, m, the space between them counts as not observed, and hits of new
/// obstacles as hits on different bodies.
const MAX_GAP_M: f64 = 0.15;
/// The number of scans with a hit after which a free or unknown cell becomes blocked.
const HITS_TO_BLOCK: u16 = 2;
/// The number of scans that must pass an unknown cell until it becomes free; and one beside a surface, of which it can still be a
/// part.
const MISSES_TO_DISCOVER: i8 = 3;
const MISSES_TO_DISCOVER_BESIDE: i8 = 20;
/// The number of hits after which a surface counts as permanent: noise around it is then not a new obstacle. The surface of a
/// cell that was never free needs at most the hits of 4 s, at least [`HITS_TO_BLOCK`].
const HITS_TO_STAND: u16 = 20;
/// A first observation that is contradicted after less than this time in view, s, and less than [`MIN_CONFIRMING`] readings, was
/// wrong. The state is corrected, which does not count as a change.
const CONFIRM_S: f64 = 2.0;
/// The same for a free cell that was passed only in part: most of a cell behind a thin wall is free.
const CONFIRM_PARTLY_S: f64 = 20.0;
/// The mean of the hit points is taken over about this number of hits.
const SURFACE_MEMORY: u16 = 32;
/// A first observation needs at least this number of readings to be confirmed, however long they take.
const MIN_CONFIRMING: f64 = 5.0;

/// The hits in a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
struct Surface {
    /// The mean of the points that were hit, relative to the lower left corner of the grid, m.
    point_m: [f32; 2],
    /// The normal of the surface, toward the sensor, in hundredths; 0 if both faces were seen.
    facing: [i8; 2],
    /// The number of scans with a hit in this cell since the cell was last free.
    hits: u16,
    /// The reading of the last hit.
    hit_at: ReadingIndex,
    /// The last reading in which a surface between two hits went through the cell.
    surface_at: ReadingIndex,
    /// Whether the cell was free before, so that the surface is that of a new obstacle.
    came: bool,
    /// Whether the free cell was passed only in part before its first hit.
    partly_free: bool,
    /// The reading at which the evidence against the present state began, and whether the cell was in view then.
    doubted_since: ReadingIndex,
    doubted_in_view: bool,
}

/// See the documentation of this module.
#[derive(Clone, Debug)]
pub(super) struct SurfaceGrid {
    settings: SurfaceGridSettings,
    surfaces: Surfaces,
    /// For an unknown or free cell: the number of consecutive hits (above 0) or misses (below 0; of a free cell only until a
    /// scan passes all of it, [`Self::free_evidence`]). For a blocked
    /// cell: the number of misses left until the cell becomes free. Apart from the surfaces, because every cell that was seen has
    /// evidence, and most have no surface.
    evidence: SparseCells<i8>,
    footprint: Footprint,
    segmentation: Segmentation,
    /// Scratch memory: for each beam the cell right behind its hit, see [`Self::find_ahead`].
    ahead: Vec<Option<usize>>,
    /// Scratch memory: the cells of a scan that are not settled.
    unsettled: Vec<u32>,
    /// Scratch memory: the hits of a scan on new obstacles, and those that can be on new obstacles.
    new_hits: Vec<NewHit>,
    /// Scratch memory: the hits on one body, and the body.
    body_hits: Vec<Point2<f64>>,
    body: Body,
}

impl SurfaceGrid {
    pub(super) fn new(settings: SurfaceGridSettings, cells: &mut CellMap) -> Self {
        let frame = *cells.frame();
        let mut surfaces = Surfaces::new(&frame);
        let mut evidence = SparseCells::new(frame.width(), frame.height(), 0);
        let known = cells.states().cells().other_than(CellState::Unknown);
        let known: Vec<(usize, CellState)> = known.map(|(index, state)| (index, *state)).collect();
        for (index, state) in known {
            cells.set_settled(index, state == CellState::Free);
            if state == CellState::Blocked {
                let center = frame.center(frame.cell(index)) - frame.origin();
                let point_m = [center.x as f32, center.y as f32];
                surfaces[index] = Surface { point_m, hits: HITS_TO_STAND, ..Surface::default() };
                evidence[index] = settings.misses_to_free as i8;
            }
        }
        Self {
            surfaces,
            evidence,
            settings,
            footprint: Footprint::default(),
            segmentation: Segmentation::default(),
            ahead: Vec::new(),
            unsettled: Vec::new(),
            new_hits: Vec::new(),
            body_hits: Vec::new(),
            body: Body::default(),
        }
    }

    /// Whether the first observation of a cell can still be wrong.
    fn is_unconfirmed(&self, index: usize, cells: &CellMap) -> bool {
        let confirm_s = if self.surfaces[index].partly_free { CONFIRM_PARTLY_S } else { CONFIRM_S };
        cells.is_unconfirmed(index, confirm_s.max(MIN_CONFIRMING * cells.period()))
    }
}

impl OccupancyModel for SurfaceGrid {
    fn update(&mut self, scan: &ProjectedScan, cells: &mut CellMap) {
        self.segmentation.segment(scan, JOIN_M);
        self.new_hits.clear();
        self.find_ahead(scan, cells);
        for beam in 0..scan.len() {
            self.hit(beam, scan, cells);
        }
        self.misses(scan, cells);
        self.bodies(scan, cells);
    }

    fn is_doubted(&self, index: usize, cells: &CellMap) -> bool {
        match cells.state(index) {
            CellState::Blocked => {
                let surface = &self.surfaces[index];
                surface.doubted_since > surface.hit_at
            }
            CellState::Free => self.evidence[index] > 0,
            CellState::Unknown => false,
        }
    }

    fn values(&mut self) -> Values<'_> {
        vec![cell_runs(&mut self.surfaces, usize::MAX), cell_runs(&mut self.evidence, usize::MAX)]
    }

    fn bytes(&self) -> usize {
        self.surfaces.bytes() + self.evidence.bytes()
    }

    fn grow(&mut self, growth: &Growth, settings: &MapperSettings) {
        self.settings = settings.steady;
        let shift_m = growth.shift_m();
        for surface in self.surfaces.all_mut().filter(|surface| surface.point_m != [0.0; 2]) {
            for (at, shift_m) in surface.point_m.iter_mut().zip(shift_m.iter()) {
                *at = (f64::from(*at) + shift_m) as f32;
            }
        }
        self.surfaces.grow(growth);
        growth.sparse(&mut self.evidence);
    }
}

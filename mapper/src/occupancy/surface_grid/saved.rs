//! The surfaces in a state file.

use super::surfaces::Surfaces;
use super::{Surface, SurfaceGrid};
use crate::change::ReadingIndex;
use interfaces::{CellList, SparseCells, ValueError, write_value};

/// What a state file holds of a cell.
#[derive(serde::Deserialize, serde::Serialize)]
pub(super) struct SavedSurface {
    point_m: [f32; 2],
    hits: u16,
    evidence: i8,
    hit_at: ReadingIndex,
    surface_at: ReadingIndex,
    came: bool,
    doubted_since: ReadingIndex,
    doubted_in_view: bool,
}

/// The surfaces of all cells, with the evidence.
pub(super) struct SavedSurfaces<'a> {
    surfaces: &'a mut Surfaces,
    evidence: &'a mut SparseCells<i8>,
}

impl SurfaceGrid {
    pub(super) fn saved(&mut self) -> SavedSurfaces<'_> {
        SavedSurfaces { surfaces: &mut self.surfaces, evidence: &mut self.evidence }
    }
}

impl CellList for SavedSurfaces<'_> {
    type Item = SavedSurface;

    fn len(&self) -> usize {
        self.surfaces.len()
    }

    fn write(&self, index: usize, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
        let Surface { point_m, hits, hit_at, surface_at, came, doubted_since, doubted_in_view } =
            self.surfaces[index];
        let evidence = self.evidence[index];
        let saved = SavedSurface {
            point_m,
            hits,
            evidence,
            hit_at,
            surface_at,
            came,
            doubted_since,
            doubted_in_view,
        };
        write_value(&saved, bytes)
    }

    fn alike(&self, index: usize) -> usize {
        self.surfaces.alike(index).min(self.evidence.alike(index))
    }

    fn set(&mut self, index: usize, value: &SavedSurface) {
        let SavedSurface {
            point_m,
            hits,
            evidence,
            hit_at,
            surface_at,
            came,
            doubted_since,
            doubted_in_view,
        } = *value;
        self.evidence.set(index, evidence);
        let surface = Surface { point_m, hits, hit_at, surface_at, came, doubted_since, doubted_in_view };
        self.surfaces.set(index, surface);
    }
}

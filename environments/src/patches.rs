//! The map at the resolution of patches: what a learner sees of it.

use interfaces::{Cell, CellState, GridFrame};
use mapper::Mapper;

/// The side of a patch, m.
const PATCH_M: f64 = 0.5;
/// The cells that are read in a patch, along each side.
const SAMPLES: usize = 2;
/// The time after which the recency of a cell is 1 − 1/e, s.
const RECENCY_S: f64 = 60.0;

/// The layers of [`Patches::write`].
pub(crate) const LAYERS: [(&str, usize); 4] = [("seen", 1), ("blocked", 1), ("age", 1), ("changed", 1)];

/// A grid of patches that covers the largest of several maps.
#[derive(Clone, Debug)]
pub(crate) struct Patches {
    pub(crate) rows: usize,
    pub(crate) columns: usize,
}

impl Patches {
    pub(crate) fn covering<'a>(frames: impl Iterator<Item = &'a GridFrame>) -> Self {
        let count = |cells: usize, frame: &GridFrame| {
            (cells as f64 * frame.resolution_m() / PATCH_M - 1e-6).ceil() as usize
        };
        frames.fold(Self { rows: 1, columns: 1 }, |most, frame| Self {
            rows: most.rows.max(count(frame.height(), frame)),
            columns: most.columns.max(count(frame.width(), frame)),
        })
    }

    /// The number of values of all layers.
    pub(crate) fn len(&self) -> usize {
        LAYERS.len() * self.rows * self.columns
    }

    /// Writes four layers, row 0 at the lowest y, each with values from 0 to 1: the share of the patch that was seen,
    /// the share that is blocked, how long ago it was seen (1 − e^(−time / 60 s); 1 where it was never seen), and the
    /// mean probability that a cell changed since then. Four cells are read in each patch; beyond the map all is 0.
    pub(crate) fn write(&self, mapper: &Mapper, layers: &mut [f32]) {
        layers.fill(0.0);
        let (frame, size) = (mapper.frame(), self.rows * self.columns);
        let per_patch = PATCH_M / frame.resolution_m();
        let cell = |patch: usize, sample: usize| {
            ((patch as f64 + (sample as f64 + 0.5) / SAMPLES as f64) * per_patch) as i32
        };
        let weight = 1.0 / (SAMPLES * SAMPLES) as f32;
        for patch in 0..size {
            let (row, column) = (patch / self.columns, patch % self.columns);
            for sample in 0..SAMPLES * SAMPLES {
                let at = Cell::new(cell(column, sample % SAMPLES), cell(row, sample / SAMPLES));
                let Some(index) = frame.index(at) else { continue };
                if !mapper.was_ever_seen(index) {
                    layers[2 * size + patch] += weight;
                    continue;
                }
                let is_blocked = mapper.states().cells()[index] == CellState::Blocked;
                let age = 1.0 - libm::exp(-mapper.recency(index) / RECENCY_S);
                layers[patch] += weight;
                layers[size + patch] += weight * f32::from(u8::from(is_blocked));
                layers[2 * size + patch] += weight * age as f32;
                layers[3 * size + patch] += weight * mapper.change_probability(index) as f32;
            }
        }
    }
}

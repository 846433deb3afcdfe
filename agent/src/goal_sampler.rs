//! Selects a goal by the weights of a strategy.
//!
//! The map is divided into square patches of `patch_cells` × `patch_cells` cells, from its lower left corner on;
//! patches at the right and upper border can be smaller. The weight of a patch is the mean over its candidates, not
//! over all its cells: a patch that consists mostly of wall does not weigh less. A patch is drawn with a
//! probability proportional to its weight, and the goal is uniform over the candidates of the patch. If no
//! candidate has a weight, the goal is uniform over all candidates; if there is no candidate, the goal is the cell
//! of the robot.

use crate::sampling::proportional;
use crate::situation::Situation;
use crate::strategies::{Pick, Stay, Strategy};
use crate::visibility::Regions;
use interfaces::{Cell, RandomStream};
use mapper::Mapper;
use rand::RngExt;

/// The limit of weights: larger weights count as this value. The limit is far above any time in seconds, and small
/// enough that no sum over a map overflows.
const MAX_WEIGHT: f64 = 1e200;

/// A goal, and what to do there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// The cell of the goal.
    pub cell: Cell,
    /// What to do at the goal.
    pub stay: Stay,
}

/// Samples goals; reuses its buffers.
#[derive(Clone, Debug)]
pub(crate) struct GoalSampler {
    patch_cells: usize,
    /// One weight per cell, as written by the strategy.
    weights: Vec<f64>,
    /// Row-major, like the cells.
    patches: Vec<Patch>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Patch {
    /// Sum over the candidates.
    weight: f64,
    candidates: usize,
}

impl Patch {
    fn mean(&self) -> f64 {
        if self.candidates == 0 { 0.0 } else { self.weight / self.candidates as f64 }
    }
}

impl GoalSampler {
    /// A sampler with patches of `patch_cells` × `patch_cells` cells; at least one cell.
    pub(crate) fn new(patch_cells: usize) -> Self {
        Self { patch_cells, weights: Vec::new(), patches: Vec::new() }
    }

    /// Selects a goal by the weights of `strategy`.
    pub(crate) fn sample(
        &mut self,
        strategy: &mut dyn Strategy,
        situation: &Situation,
        rng: &mut RandomStream,
    ) -> Goal {
        let mapper = situation.mapper;
        self.weights.clear();
        self.weights.resize(mapper.frame().len(), 0.0);
        strategy.weigh(situation, &mut self.weights);
        let best = match strategy.pick() {
            Pick::Patch => None,
            Pick::Best => self.best(mapper, rng),
        };
        let cell = best.unwrap_or_else(|| {
            self.gather(mapper);
            self.draw(mapper, rng).unwrap_or_else(|| situation.cell())
        });
        Goal { cell, stay: strategy.stay(cell) }
    }

    /// The candidate with the largest weight, a random one of several equal ones; `None` if no weight is above
    /// zero.
    fn best(&self, mapper: &Mapper, rng: &mut RandomStream) -> Option<Cell> {
        let (mut best, mut largest, mut ties) = (None, 0.0, 0);
        for (index, &weight) in self.weights.iter().enumerate() {
            // A comparison with NaN is false: a weight that is NaN is never selected.
            if weight >= largest && weight > 0.0 && mapper.is_candidate(index) {
                ties = if weight > largest { 1 } else { ties + 1 };
                if weight > largest || rng.random_range(0..ties) == 0 {
                    (best, largest) = (Some(index), weight);
                }
            }
        }
        best.map(|index| mapper.frame().cell(index))
    }

    /// A candidate drawn by the weights of the patches; `None` if there is no candidate.
    fn draw(&self, mapper: &Mapper, rng: &mut RandomStream) -> Option<Cell> {
        let drawn = proportional(self.patches.iter().map(Patch::mean), rng);
        let patches = drawn.map_or(0..self.patches.len(), |patch| patch..patch + 1);
        let candidates: usize = self.patches[patches.clone()].iter().map(|patch| patch.candidates).sum();
        let nth = (candidates > 0).then(|| rng.random_range(0..candidates))?;
        let regions = Regions::with_side(*mapper.frame(), self.patch_cells);
        let mut cells =
            patches.flat_map(|patch| regions.cells(patch)).filter(|&cell| mapper.is_candidate(cell));
        cells.nth(nth).map(|index| mapper.frame().cell(index))
    }

    /// Sums weights and candidates over the patches.
    fn gather(&mut self, mapper: &Mapper) {
        let (width, height, side) = (mapper.frame().width(), mapper.frame().height(), self.patch_cells);
        let columns = width.div_ceil(side);
        self.patches.clear();
        self.patches.resize(columns * height.div_ceil(side), Patch::default());
        let mut index = 0;
        for (row, weights) in self.weights.chunks_exact(width).enumerate() {
            let patches = &mut self.patches[row / side * columns..][..columns];
            for (patch, weights) in patches.iter_mut().zip(weights.chunks(side)) {
                for &weight in weights {
                    if mapper.is_candidate(index) {
                        patch.candidates += 1;
                        if weight > 0.0 {
                            patch.weight += weight.min(MAX_WEIGHT);
                        }
                    }
                    index += 1;
                }
            }
        }
    }
}

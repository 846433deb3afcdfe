//! From the weights of a strategy to a goal.
//!
//! The map is cut into square patches of `patch_cells` × `patch_cells` cells, from its lower left corner on;
//! those at the right and upper border can be smaller. The weight of a patch is the mean over its candidates,
//! not over all its cells: a patch is not worth less for being mostly wall. A patch is drawn in proportion to
//! its weight, and the goal is uniform over the candidates of the patch. Where no candidate has a weight, the
//! goal is uniform over all candidates; where there is no candidate, the goal is the cell of the robot.

use crate::sampling::proportional;
use crate::situation::Situation;
use crate::strategies::{Pick, Stay, Strategy};
use crate::visibility::Regions;
use interfaces::{Cell, RandomStream};
use mapper::Mapper;
use rand::RngExt;

/// Larger weights count as this: far above any time in seconds, and so far below the largest number that no
/// sum over a map overflows.
const MAX_WEIGHT: f64 = 1e200;

/// Where to go next, and what to do there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Where to go.
    pub cell: Cell,
    /// What to do there.
    pub stay: Stay,
}

/// Samples goals; keeps its buffers from goal to goal.
#[derive(Clone, Debug)]
pub(crate) struct GoalSampler {
    patch_cells: usize,
    /// One per cell, as written by the strategy.
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
    /// A sampler over patches of `patch_cells` cells in a row, at least one.
    pub(crate) fn new(patch_cells: usize) -> Self {
        Self { patch_cells, weights: Vec::new(), patches: Vec::new() }
    }

    /// A goal by the weights of `strategy`.
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

    /// The candidate of the largest weight, uniform over several; `None` where no weight is above zero.
    fn best(&self, mapper: &Mapper, rng: &mut RandomStream) -> Option<Cell> {
        let (mut best, mut largest, mut ties) = (None, 0.0, 0);
        for (index, &weight) in self.weights.iter().enumerate() {
            // A weight that is not a number is not larger than any.
            if weight >= largest && weight > 0.0 && mapper.is_candidate(index) {
                ties = if weight > largest { 1 } else { ties + 1 };
                if weight > largest || rng.random_range(0..ties) == 0 {
                    (best, largest) = (Some(index), weight);
                }
            }
        }
        best.map(|index| mapper.frame().cell(index))
    }

    /// A candidate by the weights of the patches; `None` where there is no candidate.
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

//! Selects a goal by the weights of a strategy.
//!
//! The map is divided into square patches of `patch_cells` × `patch_cells` cells, from its lower left corner on;
//! patches at the right and upper border can be smaller. The weight of a patch is the mean over its candidates, not
//! over all its cells: a patch that consists mostly of wall does not weigh less. A patch is drawn with a
//! probability proportional to its weight, and the goal is uniform over the candidates of the patch. If no
//! candidate has a weight, the goal is uniform over all candidates; if there is no candidate, the goal is the cell
//! of the robot.

use crate::situation::Situation;
use crate::strategies::{Pick, Stay, Strategy};
use crate::visibility::Regions;
use interfaces::{Cell, RandomStream};
use mapper::Mapper;
use nalgebra::Point2;
use rand::RngExt;

/// The limit of weights: larger weights count as this value. The limit is far above any time in seconds, and small
/// enough that no sum over a map overflows.
const MAX_WEIGHT: f64 = 1e200;

/// A goal, and what to do there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// The position of the goal, m.
    pub position: Point2<f64>,
    /// What to do at the goal.
    pub stay: Stay,
}

/// Selects a goal by the weights of `strategy`, with patches of `patch_cells` × `patch_cells` cells; at least one cell.
pub(crate) fn sample(
    patch_cells: usize,
    strategy: &mut dyn Strategy,
    situation: &Situation,
    rng: &mut RandomStream,
) -> Goal {
    let mapper = situation.mapper;
    let mut weights = vec![0.0; mapper.frame().len()];
    strategy.weigh(situation, &mut weights);
    let best = match strategy.pick() {
        Pick::Patch => None,
        Pick::Best => best(&weights, mapper, rng),
    };
    let cell = best.or_else(|| draw(patch_cells, &weights, mapper, rng)).unwrap_or_else(|| situation.cell());
    Goal { position: mapper.frame().center(cell), stay: strategy.stay(cell) }
}

/// The candidate with the largest weight above zero; a random one of several.
fn best(weights: &[f64], mapper: &Mapper, rng: &mut RandomStream) -> Option<Cell> {
    let (mut best, mut largest, mut ties) = (None, 0.0, 0);
    for (index, &weight) in weights.iter().enumerate() {
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

/// A candidate of a patch that is drawn by its mean weight, or of all patches if none has a weight.
fn draw(patch_cells: usize, weights: &[f64], mapper: &Mapper, rng: &mut RandomStream) -> Option<Cell> {
    let regions = Regions::with_side(*mapper.frame(), patch_cells);
    let candidates = |patch: usize| regions.cells(patch).filter(move |&cell| mapper.is_candidate(cell));
    let patch = |patch: usize| {
        let (mut weight, mut count) = (0.0, 0_usize);
        for cell in candidates(patch) {
            count += 1;
            if weights[cell] > 0.0 {
                weight += weights[cell].min(MAX_WEIGHT);
            }
        }
        (weight / count.max(1) as f64, count)
    };
    let patches: Vec<(f64, usize)> = (0..regions.count()).map(patch).collect();
    let drawn = proportional(patches.iter().map(|(mean, _)| *mean), rng);
    let drawn = drawn.map_or(0..patches.len(), |patch| patch..patch + 1);
    let count: usize = patches[drawn.clone()].iter().map(|(_, count)| count).sum();
    let nth = (count > 0).then(|| rng.random_range(0..count))?;
    drawn.flat_map(candidates).nth(nth).map(|index| mapper.frame().cell(index))
}

/// Draws an index with a probability proportional to its weight; `None` if no weight is above zero. The weights
/// must be finite and not negative, and their sum must be finite.
pub(crate) fn proportional(
    weights: impl Iterator<Item = f64> + Clone,
    rng: &mut RandomStream,
) -> Option<usize> {
    let total: f64 = weights.clone().sum();
    if total <= 0.0 {
        return None;
    }
    let mut left = rng.random::<f64>() * total;
    let mut drawn = None;
    for (index, weight) in weights.enumerate().filter(|&(_, weight)| weight > 0.0) {
        // If rounding leaves a remainder after the last weight, the last index is drawn.
        drawn = Some(index);
        if left < weight {
            break;
        }
        left -= weight;
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Purpose;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_weight_of_zero_is_never_drawn(
            weights in prop::collection::vec(prop_oneof![Just(0.0), 0.0..1e-300, 0.0..1e200], 0..20),
            seed in any::<u64>(),
        ) {
            let mut rng = RandomStream::new(seed, Purpose::Agent);
            match proportional(weights.iter().copied(), &mut rng) {
                Some(index) => prop_assert!(weights[index] > 0.0),
                None => prop_assert!(weights.iter().all(|&weight| weight == 0.0)),
            }
        }
    }
}

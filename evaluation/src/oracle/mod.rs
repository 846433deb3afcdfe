//! The oracle: a goal selector that knows the true rates, as a reference for strategies in both kinds of world.

mod expectation;
mod patches;
#[cfg(test)]
mod tests;

use agent::{Stay, Travel};
use expectation::{Knowledge, gap_worth};
use interfaces::GroundTruth;
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use patches::Patches;
use robot::{Destination, GoalSelector};
use sim::grid::GridSpec;
use sim::physics::WorldSpec;

/// The durations of a stop that the oracle considers: steps, or s in a physics world.
const STAYS: [f64; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];

/// The minimum trust in a patch, so that a patch is visited again if all others are worse.
const MIN_TRUST: f64 = 0.01;

/// Goes to the patch from which the log error of the rates is expected to decrease most per unit of time, travel
/// included, and stays for the best duration. The oracle knows the walls (and the furniture of a physics world) and the
/// true rates so far, but not the future positions of what moves: it is greedy, not optimal. A patch is a cell of a grid
/// world, and a square of 0.25 m in a physics world.
///
/// All moving things have the same weight, and all cells of the path of a thing have the same weight, as in the log
/// error. The expectation takes only the walls into account, but a block, a person or a door can hide cells, including
/// the cell that it will enter next. The oracle therefore learns for each patch which share of the expectation comes
/// true (the trust). Without trust the oracle would stay forever at the first such patch.
#[derive(Clone, Debug)]
pub struct Oracle {
    patches: Patches,
    /// Whether a look at a cell after a gap counts for what the gap tells. In grid worlds only time in view counts.
    counts_gaps: bool,
    /// The true cycle rate of every cell.
    rates: Vec<f64>,
    /// The weight of every cell in the log error.
    weights: Vec<f64>,
    /// The time of the true rates.
    learned_at: f64,
    /// For each patch the share of the expectation that came true.
    trust: Vec<f64>,
    last: Option<Expected>,
}

/// The expectation of the last goal.
#[derive(Clone, Debug)]
struct Expected {
    patch: usize,
    stay: f64,
    fall: f64,
    /// The error of the cells in view when the goal was selected.
    error: f64,
}

impl Oracle {
    /// An oracle for a robot in a grid world.
    pub fn in_grid(world: &GridSpec) -> Self {
        Self::new(Patches::of_grid(world), world.frame().len(), false)
    }

    /// An oracle for the driven robot of a physics world.
    pub fn in_physics(world: &WorldSpec) -> Self {
        Self::new(Patches::of_physics(world), world.frame.len(), true)
    }

    fn new(patches: Patches, cells: usize, counts_gaps: bool) -> Self {
        Self {
            counts_gaps,
            rates: vec![0.0; cells],
            weights: vec![0.0; cells],
            learned_at: f64::NEG_INFINITY,
            trust: vec![1.0; patches.len()],
            last: None,
            patches,
        }
    }

    /// Updates the true rates, if a step (in a physics world: a second) has passed; called at every reading.
    pub fn learn(&mut self, truth: &impl GroundTruth) {
        if truth.elapsed() < self.learned_at + 1.0 {
            return;
        }
        self.learned_at = truth.elapsed();
        for &cell in truth.swept().iter() {
            self.rates[cell] = truth.cycle_rate(cell);
            self.weights[cell] = 0.0;
        }
        for thing in truth.moving_things().iter() {
            let share = 1.0 / thing.len() as f64;
            thing.iter().for_each(|&cell| self.weights[cell] += share);
        }
    }

    /// The cells of a patch that truly change.
    fn changing(&self, patch: usize) -> impl Iterator<Item = usize> {
        self.patches.cells[patch].iter().copied().filter(|&cell| self.rates[cell] > 0.0)
    }

    /// The weighted error of the cells in view from a patch.
    fn error(&self, mapper: &Mapper, from: usize) -> f64 {
        let cells = self.patches.in_view[from].iter().flat_map(|&patch| self.changing(patch));
        cells.map(|cell| self.weights[cell] * knowledge(mapper, cell, self.rates[cell]).error()).sum()
    }

    /// Compares the result of the last goal with its expectation.
    fn update_trust(&mut self, mapper: &Mapper) {
        let Some(last) = self.last.take() else { return };
        if last.fall > 0.0 {
            let share = (last.error - self.error(mapper, last.patch)) / last.fall;
            let trust = &mut self.trust[last.patch];
            *trust = (0.5 * (*trust + share.clamp(0.0, 1.0))).max(MIN_TRUST);
        }
    }

    /// The expected fall of the error of a patch, for each stay; `None` if nothing changes there.
    fn falls(&self, mapper: &Mapper, patch: usize) -> Option<[f64; STAYS.len()]> {
        let falls = self.changing(patch).map(|cell| {
            let (rate, weight) = (self.rates[cell], self.weights[cell]);
            let knowledge = knowledge(mapper, cell, rate);
            let gap = if self.counts_gaps { gap_worth(mapper.recency(cell), rate) } else { 0.0 };
            STAYS.map(|stay| weight * knowledge.expected_fall(stay + gap))
        });
        falls.reduce(|sums, falls| std::array::from_fn(|stay| sums[stay] + falls[stay]))
    }

    /// The best patch and duration, given the travel times to all cells; `None` if no decrease is expected anywhere.
    fn best(&self, mapper: &Mapper, times: &[f64]) -> Option<Expected> {
        let falls: Vec<_> = (0..self.patches.len()).map(|patch| self.falls(mapper, patch)).collect();
        let (mut best, mut most) = (None, 0.0);
        for patch in 0..self.patches.len() {
            let time = times.get(self.patches.middles[patch]).copied().unwrap_or(f64::INFINITY);
            if !time.is_finite() {
                continue;
            }
            let mut sums = [0.0; STAYS.len()];
            for falls in self.patches.in_view[patch].iter().filter_map(|&seen| falls[seen]) {
                sums.iter_mut().zip(falls).for_each(|(sum, fall)| *sum += fall);
            }
            for (stay, fall) in STAYS.into_iter().zip(sums) {
                let worth = self.trust[patch] * fall / (time + stay);
                if worth > most {
                    (best, most) = (Some((patch, stay, fall)), worth);
                }
            }
        }
        best.map(|(patch, stay, fall)| Expected { patch, stay, fall, error: self.error(mapper, patch) })
    }
}

fn knowledge(mapper: &Mapper, cell: usize, truth: f64) -> Knowledge {
    let seen = mapper.statistics(cell);
    Knowledge {
        truth,
        estimate: mapper.rate(cell),
        events: f64::from(seen.block_events) + f64::from(seen.free_events),
        watched: seen.observed(),
    }
}

impl GoalSelector for Oracle {
    fn next_goal(
        &mut self,
        pose: &Isometry2<f64>,
        mapper: &Mapper,
        travel: &mut impl Travel,
    ) -> Option<Destination> {
        self.update_trust(mapper);
        let mut times = Vec::new();
        travel.times(mapper, pose, &mut times);
        self.last = self.best(mapper, &times);
        let frame = mapper.frame();
        Some(match &self.last {
            Some(best) => {
                let cell = frame.cell(self.patches.middles[best.patch]);
                Destination { position: frame.center(cell), stay: Stay::Watch(best.stay) }
            }
            // Nothing has moved yet, or everything is known: wait for one step or second.
            None => Destination { position: Point2::from(pose.translation.vector), stay: Stay::Watch(1.0) },
        })
    }

    fn reason(&self) -> String {
        match &self.last {
            Some(best) => format!("oracle: {:.3} expected of a stay of {}", best.fall, best.stay),
            None => "oracle: nothing expected".into(),
        }
    }
}

//! The oracle: a goal selector that knows the true rates, as a reference for strategies.

mod expectation;
#[cfg(test)]
mod tests;

use agent::{Stay, Travel};
use expectation::Knowledge;
use interfaces::GroundTruth;
use mapper::Mapper;
use nalgebra::Point2;
use robot::{Belief, Destination, GoalSelector};
use sim::grid::{GridGroundTruth, GridSpec};

/// The durations of a stop that the oracle considers, steps.
const STAYS: [f64; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];

/// The minimum trust in a cell, so that a cell is visited again if all others are worse.
const LEAST_TRUST: f64 = 0.01;

/// Goes to the cell from which the log error of the rates is expected to decrease most per step, travel included,
/// and stays for the best duration. The oracle knows the walls and the true rates so far, but not the future
/// positions of the blocks: it is greedy, not optimal.
///
/// All moving things have the same weight, and all cells of the path of a thing have the same weight, as in the log
/// error. The expectation takes only the walls into account, but a block can hide cells, including the cell that it
/// will enter next. The oracle therefore learns for each cell which share of the expectation comes true (the
/// trust). Without trust the oracle would stay forever at the first such cell.
#[derive(Clone, Debug)]
pub struct Oracle {
    /// The cells in view from every cell.
    sights: Vec<Vec<usize>>,
    /// The true cycle rate of every cell.
    rates: Vec<f64>,
    /// The weight of every cell in the log error.
    weights: Vec<f64>,
    /// For each cell the share of the expectation that came true.
    trust: Vec<f64>,
    last: Option<Expected>,
}

/// The expectation of the last goal.
#[derive(Clone, Debug)]
struct Expected {
    cell: usize,
    stay: f64,
    fall: f64,
    /// The error of the cells in view when the goal was selected.
    error: f64,
}

impl Oracle {
    /// An oracle for a robot in this world.
    pub fn new(world: &GridSpec) -> Self {
        let cells = world.frame().len();
        Self {
            sights: world.sights(),
            rates: vec![0.0; cells],
            weights: vec![0.0; cells],
            trust: vec![1.0; cells],
            last: None,
        }
    }

    /// Updates the true rates; called at every step.
    pub fn learn(&mut self, truth: &GridGroundTruth) {
        for &cell in truth.swept().iter() {
            self.rates[cell] = truth.cycle_rate(cell);
            self.weights[cell] = 0.0;
        }
        for thing in truth.moving_things().iter() {
            let share = 1.0 / thing.len() as f64;
            thing.iter().for_each(|&cell| self.weights[cell] += share);
        }
    }

    /// The weighted error of the cells in view from a cell.
    fn error(&self, mapper: &Mapper, from: usize) -> f64 {
        let cells = self.sights[from].iter().filter(|&&cell| self.rates[cell] > 0.0);
        cells.map(|&cell| self.weights[cell] * knowledge(mapper, cell, self.rates[cell]).error()).sum()
    }

    /// Compares the result of the last goal with its expectation.
    fn update_trust(&mut self, mapper: &Mapper) {
        let Some(last) = self.last.take() else { return };
        if last.fall > 0.0 {
            let share = (last.error - self.error(mapper, last.cell)) / last.fall;
            let trust = &mut self.trust[last.cell];
            *trust = (0.5 * (*trust + share.clamp(0.0, 1.0))).max(LEAST_TRUST);
        }
    }

    /// The best cell and duration, given the travel times; `None` if no decrease is expected anywhere.
    fn best(&self, mapper: &Mapper, times: &[f64]) -> Option<Expected> {
        // The expected fall of the error of each cell, for each stay.
        let falls: Vec<Option<[f64; STAYS.len()]>> = (0..self.rates.len())
            .map(|cell| {
                let (rate, weight) = (self.rates[cell], self.weights[cell]);
                let knowledge = (rate > 0.0).then(|| knowledge(mapper, cell, rate))?;
                Some(STAYS.map(|stay| weight * knowledge.expected_fall(stay)))
            })
            .collect();
        let (mut best, mut most) = (None, 0.0);
        for (cell, sight) in self.sights.iter().enumerate() {
            let time = times.get(cell).copied().unwrap_or(f64::INFINITY);
            if !time.is_finite() {
                continue;
            }
            let mut sums = [0.0; STAYS.len()];
            for falls in sight.iter().filter_map(|&seen| falls[seen]) {
                sums.iter_mut().zip(falls).for_each(|(sum, fall)| *sum += fall);
            }
            for (stay, fall) in STAYS.into_iter().zip(sums) {
                let worth = self.trust[cell] * fall / (time + stay);
                if worth > most {
                    (best, most) = (Some((cell, stay, fall)), worth);
                }
            }
        }
        best.map(|(cell, stay, fall)| Expected { cell, stay, fall, error: self.error(mapper, cell) })
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
    fn next_goal(&mut self, belief: &Belief, travel: &mut impl Travel) -> Option<Destination> {
        self.update_trust(belief.mapper);
        let mut times = Vec::new();
        travel.times(belief.mapper, belief.pose, &mut times);
        self.last = self.best(belief.mapper, &times);
        let frame = belief.mapper.frame();
        Some(match &self.last {
            Some(best) => {
                Destination { position: frame.center(frame.cell(best.cell)), stay: Stay::Watch(best.stay) }
            }
            // Nothing has moved yet, or everything is known: wait for one step.
            None => {
                Destination { position: Point2::from(belief.pose.translation.vector), stay: Stay::Watch(1.0) }
            }
        })
    }

    fn reason(&self) -> String {
        match &self.last {
            Some(best) => format!("oracle: {:.3} expected in {} steps", best.fall, best.stay),
            None => "oracle: nothing expected".into(),
        }
    }
}

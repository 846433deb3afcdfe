//! A guide that knows what no robot can: the reference that strategies are measured against.

mod expectation;
#[cfg(test)]
mod tests;

use agent::{Stay, Travel};
use expectation::Knowledge;
use interfaces::GroundTruth;
use mapper::Mapper;
use nalgebra::Point2;
use robot::{Belief, Destination, GoalSelector};
use sim::grid::{GridSpec, GridTruth};

/// How long it considers to stay, steps.
const STAYS: [f64; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];

/// The least trust in a place, so that it is tried again when all others are worse.
const LEAST_TRUST: f64 = 0.01;

/// Goes where the log error of the rates is expected to fall most per step, on the way included, and
/// stays there for as long as that is best. It knows the walls and the true rates so far, but not where
/// the blocks will be: it is greedy, not the best that can be.
///
/// Every moving thing weighs the same, and every cell of its path, as in the error itself. What it
/// expects is by the walls alone. A block can hide cells for as long as the robot looks from there, of
/// all things the one that it is about to enter: so the oracle learns how much of what it expects of a
/// place comes true there. Without this it would park in the first such place.
#[derive(Clone, Debug)]
pub struct Oracle {
    /// What is in view from every cell.
    sights: Vec<Vec<usize>>,
    /// The true cycle rate of every cell.
    rates: Vec<f64>,
    /// What every cell counts for in the error.
    weights: Vec<f64>,
    /// The share of what was expected from looking there that came true.
    trust: Vec<f64>,
    last: Option<Expected>,
}

/// What was expected of the last goal.
#[derive(Clone, Debug)]
struct Expected {
    place: usize,
    stay: f64,
    fall: f64,
    /// The error of the cells in view at the time.
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

    /// Takes in how often every cell has truly changed so far. To be told at every step.
    pub fn learn(&mut self, truth: &GridTruth) {
        for &cell in truth.swept() {
            self.rates[cell] = truth.cycle_rate(cell);
            self.weights[cell] = 0.0;
        }
        for thing in truth.moving_things().iter() {
            let share = 1.0 / thing.len() as f64;
            thing.iter().for_each(|&cell| self.weights[cell] += share);
        }
    }

    /// The error of what is in view from a place, as it counts.
    fn error(&self, mapper: &Mapper, place: usize) -> f64 {
        let cells = self.sights[place].iter().filter(|&&cell| self.rates[cell] > 0.0);
        cells.map(|&cell| self.weights[cell] * knowledge(mapper, cell, self.rates[cell]).error()).sum()
    }

    /// Compares what came of the last goal with what was expected of it.
    fn look_back(&mut self, mapper: &Mapper) {
        let Some(last) = self.last.take() else { return };
        if last.fall > 0.0 {
            let share = (last.error - self.error(mapper, last.place)) / last.fall;
            let trust = &mut self.trust[last.place];
            *trust = (0.5 * (*trust + share.clamp(0.0, 1.0))).max(LEAST_TRUST);
        }
    }

    /// The best place and stay by the times to every cell; `None` where nothing is expected anywhere.
    fn best(&self, mapper: &Mapper, times: &[f64]) -> Option<Expected> {
        // What each cell is expected to bring, for each stay.
        let falls: Vec<Option<[f64; STAYS.len()]>> = (0..self.rates.len())
            .map(|cell| {
                let (rate, weight) = (self.rates[cell], self.weights[cell]);
                let knowledge = (rate > 0.0).then(|| knowledge(mapper, cell, rate))?;
                Some(STAYS.map(|stay| weight * knowledge.expected_fall(stay)))
            })
            .collect();
        let (mut best, mut most) = (None, 0.0);
        for (place, sight) in self.sights.iter().enumerate() {
            let time = times.get(place).copied().unwrap_or(f64::INFINITY);
            if !time.is_finite() {
                continue;
            }
            let mut sums = [0.0; STAYS.len()];
            for falls in sight.iter().filter_map(|&cell| falls[cell]) {
                sums.iter_mut().zip(falls).for_each(|(sum, fall)| *sum += fall);
            }
            for (stay, fall) in STAYS.into_iter().zip(sums) {
                let worth = self.trust[place] * fall / (time + stay);
                if worth > most {
                    (best, most) = (Some((place, stay, fall)), worth);
                }
            }
        }
        best.map(|(place, stay, fall)| Expected { place, stay, fall, error: self.error(mapper, place) })
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
        self.look_back(belief.mapper);
        let mut times = Vec::new();
        travel.times(belief.mapper, belief.pose, &mut times);
        self.last = self.best(belief.mapper, &times);
        let frame = belief.mapper.frame();
        Some(match &self.last {
            Some(best) => {
                Destination { position: frame.center(frame.cell(best.place)), stay: Stay::Watch(best.stay) }
            }
            // Nothing has moved yet, or everything is known: wait a step.
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

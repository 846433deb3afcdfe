//! A lower bound of the Brier score of a fresh map for a robot that travels between viewpoints, in a building in which
//! things have short and long stays.
//!
//! The robot knows the habits of all things and not their future. A look from a viewpoint shows the states of its things, and
//! costs the steps of the way. The bound replaces the robot by prices (Lagrangian dual):
//!
//! - A look at a thing has a price, one for quiet and one for active hours. Each thing is planned alone, by dynamic programming
//!   backwards in time over what is believed after a look: the state, and the probability that the stay is a long one. The
//!   next look is chosen with all that earlier looks showed.
//! - The robot collects the prices of what it sees. What it can collect at most in the whole time, on any way through the
//!   building, is found by dynamic programming over viewpoints and steps. With a battery, steps outside the dock have a price
//!   too, and the permitted steps are paid for.
//!
//! For all prices, the sum of the values of the things less what the robot can collect at most is a lower bound: any
//! robot's looks are a plan for each thing, and collect no more than that. The prices that make it largest are searched
//! for.
//!
//! What makes it lower than the best strategy: prices are paid on average only; closed doors stop no look (a robot that finds
//! a door closed is charged for less than it pays); looks in the same time cell count once; a window in which the
//! next look falls is paid for, and shows all that happens in it.
//!
//! Source: Whittle, *Restless bandits: activity allocation in a changing world*, 1988 (relaxation by prices).

mod cells;
mod chain;
mod doors;
mod plan;
mod prices;
mod roads;

use cells::Cells;
use chain::Chain;
use doors::{Access, Doors};
use days::calendar::Hours;
use days::{Building, Duty};
use plan::{Planner, Prices};
use prices::{Budget, Flow};
use rayon::prelude::*;
use roads::{Clock, Roads, Rules};

/// Far from the seeds of any study.
const SEED_OF_PRICES: u64 = 1 << 40;
/// Multiples of the price of a step that are tried.
const STEP_PRICE_FACTORS: [f64; 5] = [0.85, 0.95, 1.05, 1.2, 1.4];


/// How finely the bound is computed. Finer is higher, and slower.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundSettings {
    /// The lengths of time cells in quiet and in active hours, steps.
    pub cell_steps: [usize; 2],
    /// Windows of several cells begin at least this number of their lengths after the last look.
    pub fineness: usize,
    /// After this number of steps without a look at a thing, the next one is free.
    pub longest_steps: usize,
    /// The share of the price that a look costs in the cell after one with a look: otherwise a robot that stays would collect too much.
    pub again: f64,
}

impl BoundSettings {
    /// Settings for a building: cells of a fraction of the time in which the robot can see all.
    pub fn of(building: &Building, duty: Duty) -> Self {
        let viewpoints = building.viewpoints.len();
        let mean = building.steps.iter().flatten().sum::<usize>() as f64 / (viewpoints * viewpoints) as f64;
        let around = mean * viewpoints as f64 * duty.spread();
        let at_most = |length: f64| {
            let lengths = (1..=180_usize).filter(|length| 180_usize.is_multiple_of(*length));
            lengths.take_while(|steps| *steps as f64 <= length).last().unwrap_or(1)
        };
        Self {
            cell_steps: [at_most((around / 2.0).max(60.0)), at_most((around / 12.0).clamp(3.0, 60.0))],
            fineness: 8,
            longest_steps: (64.0 * around) as usize,
            again: if duty.is_always() { 0.6 } else { 0.9 },
        }
    }
}

/// Finds lower bounds of the mean Brier score of any strategy over all things and steps, from a Monday, 0:00, on.
pub struct BuildingBound<'a> {
    building: &'a Building,
    settings: BoundSettings,
    cells: Cells,
    chains: Vec<Chain>,
    roads: Roads,
    clock: Clock,
    budget: Budget,
    prices: Vec<Prices>,
    step_price: Prices,
}

impl<'a> BuildingBound<'a> {
    /// Searches for the prices of a building, for a time of `steps`. They are those of doors of another seed than any that
    /// is asked for, so that they know nothing of the doors of those.
    ///
    /// # Panics
    ///
    /// If not all things have the same hours.
    pub fn new(building: &'a Building, duty: Duty, steps: usize, settings: BoundSettings) -> Self {
        let hours = building.things.first().map_or_else(Hours::always, |thing| thing.habit.hours.clone());
        assert!(building.things.iter().all(|thing| thing.habit.hours == hours), "things with different hours");
        let cells = Cells::new(&hours, steps, settings.cell_steps);
        let chains = building.things.par_iter().map(|thing| Chain::new(&thing.habit, &cells.runs)).collect();
        let cell = cells.cell_of_step();
        let is_active: Vec<bool> = cell.iter().map(|cell| cells.is_active[*cell]).collect();
        let mut bound = Self {
            building,
            settings,
            cells,
            chains,
            roads: Roads::new(building),
            budget: Budget::new(&is_active, duty),
            clock: Clock { cell, is_active },
            prices: Vec::new(),
            step_price: [0.0; 2],
        };
        let doors = Doors::new(building, SEED_OF_PRICES, steps);
        let table = bound.values(&doors, |_| prices::table());
        let flow = Flow::search(&table, &bound.roads, (&bound.clock, &doors), &bound.budget, settings.again);
        bound.prices = flow.prices;
        bound.step_price = flow.step;
        bound
    }

    /// The bound in the week of a seed: the doors do in it what they do in a [`days::Patrol`] of this seed. Over many seeds, no
    /// strategy is below the mean of the bounds on average; in a single week it can be by luck. NaN without a thing or a step.
    pub fn brier(&self, seed: u64) -> f64 {
        let steps = self.clock.cell.len();
        let doors = Doors::new(self.building, seed, steps);
        let values = self.values(&doors, |thing| vec![self.prices[thing]]);
        let total = values.iter().map(|values| values[0]).sum::<f64>() - self.collected(&doors);
        if std::env::var("DEBUG").is_ok() { eprintln!("V {} R {}", values.iter().map(|values| values[0]).sum::<f64>(), self.collected(&doors)); }
        total / (self.chains.len() * steps) as f64
    }

    fn values(&self, doors: &Doors, lists: impl Fn(usize) -> Vec<Prices> + Sync) -> Vec<Vec<f64>> {
        let value = |thing: usize| {
            let planner = Planner {
                cells: &self.cells,
                chain: &self.chains[thing],
                access: &Access::new(self.building, doors, &self.cells, thing),
                fineness: self.settings.fineness,
                longest: self.settings.longest_steps,
                again: self.settings.again,
            };
            planner.values(&lists(thing))
        };
        (0..self.chains.len()).into_par_iter().map(value).collect()
    }

    /// At most what a robot can collect, with what the permitted steps cost. Too low a price of a step lets the robot
    /// move all the time, too high a one is paid for all permitted steps: the best of some is taken.
    fn collected(&self, doors: &Doors) -> f64 {
        let stretch = self.clock.stretch(0..self.clock.cell.len(), doors);
        let collected = |factor: &f64| {
            let step = self.step_price.map(|price| price * factor);
            let rules = Rules { step, again: self.settings.again };
            self.roads.best_trip(&self.prices, stretch, rules, false).collected + self.budget.cost(step)
        };
        let factors: &[f64] = if self.budget.is_always { &[0.0] } else { &STEP_PRICE_FACTORS };
        factors.iter().map(collected).fold(f64::INFINITY, f64::min)
    }
}

//! A lower bound of the Brier score of a fresh map for a robot that travels between viewpoints, in a building in which
//! things have short and long stays.
//!
//! The robot knows the habits of all things and not their future. A look from a viewpoint shows the states of its things, and
//! costs the steps of the way. The bound replaces the robot by prices (Lagrangian dual):
//!
//! - A look at a thing has a price. Each thing is planned alone, by dynamic programming backwards in time over what is believed
//!   after a look: the state, and the probability that the stay is a long one. The next look is chosen with all that earlier
//!   looks showed.
//! - The robot collects the prices of what it sees. The most that it can collect in the whole time, on any way through the
//!   building, is found by dynamic programming over viewpoints and steps. With a battery, steps outside the dock have a price
//!   too, and the permitted steps are paid for.
//!
//! For all prices, the sum of the values of the things less the most that the robot can collect is a lower bound: the looks
//! of any robot are a plan for each thing, and pay for it what the robot collects. The prices that make it largest are
//! searched for.
//!
//! Doors decide what can be seen. The bound is computed for doors whose whole week is known (drawn by a seed, as in a
//! patrol of the same seed): a thing behind a closed door cannot be seen, unless the robot stays in the room. Only the
//! belief about the doors themselves does not use this knowledge. So the bound of a week is random, and the *mean* of the
//! bounds is below the mean score of every strategy.
//!
//! Why it is lower than the best strategy: prices are paid on average only; doors are known; looks in the same time cell count
//! once and show all of the cell, and so does a window of cells in which the next look falls; a robot in a room sees all
//! things of the room.
//!
//! Two details keep it valid. A robot that goes for a room finds out at once whether the door is open, by the time of its
//! arrival: that is a look at the door at the departure, and is paid for. And the value of beliefs is concave, so that
//! reading it off between the points of a grid is a lower bound.
//!
//! Source: Whittle, *Restless bandits: activity allocation in a changing world*, 1988 (relaxation by prices).

mod access;
mod cells;
mod chain;
mod doors;
mod plan;
mod prices;
mod roads;
mod trips;

use crate::calendar::Hours;
use crate::{Building, Duty};
use cells::Cells;
use chain::Chain;
use doors::Doors;
use plan::{Planner, Prices};
use prices::{Budget, Flow, Table};
use rayon::prelude::*;
use roads::Roads;
use trips::{Clock, Rules, best_trip};

/// Far from the seeds of any study.
const SEED_OF_PRICES: u64 = 1 << 40;
/// How often things are planned anew around the prices that were found.
const REFINEMENTS: usize = 2;
/// By which all prices are scaled at last. At prices of 0 the bound is 0.
const FACTORS: [f64; 6] = [0.0, 0.5, 0.75, 1.0, 1.35, 2.0];
/// Multiples of the price of a step that are tried.
const STEP_PRICE_FACTORS: [f64; 4] = [0.93, 0.98, 1.02, 1.07];

/// How finely the bound is computed. Finer is higher, and slower.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundSettings {
    /// The lengths of time cells in quiet and in active hours, steps.
    pub cell_steps: [usize; 2],
    /// Windows of several cells begin at least this number of their lengths after the last look.
    pub fineness: usize,
    /// After this number of steps without a look at a thing, the next one is free.
    pub longest_steps: usize,
    /// The share of the price of a look that is due in the cell after one with a look. Less than 1, since a robot that stays for
    /// another step would collect it twice.
    pub again: f64,
}

impl BoundSettings {
    /// Settings for a building: cells of a small fraction of the time in which the robot can see all.
    pub fn of(building: &Building, duty: Duty) -> Self {
        let viewpoints = building.viewpoints.len();
        let mean = building.steps.iter().flatten().sum::<usize>() as f64 / (viewpoints * viewpoints) as f64;
        let around = mean * viewpoints as f64 * duty.spread();
        let at_most = |length: f64| {
            let lengths = (1..=180_usize).filter(|length| 180_usize.is_multiple_of(*length));
            lengths.take_while(|steps| *steps as f64 <= length).last().unwrap_or(1)
        };
        Self {
            cell_steps: [
                at_most((around / 2.0).clamp(60.0, 90.0)),
                at_most((around / 40.0).clamp(3.0, 60.0)),
            ],
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
    step_price: f64,
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
        assert!(
            building.things.iter().all(|thing| thing.habit.hours == hours),
            "things with different hours"
        );
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
            budget: Budget::new(steps, duty),
            clock: Clock { cell, is_active },
            prices: Vec::new(),
            step_price: 0.0,
        };
        let doors = Doors::new(building, SEED_OF_PRICES, steps);
        let mut flow: Option<Flow> = None;
        for _ in 0..REFINEMENTS {
            let table = |thing: usize| {
                flow.as_ref().map_or_else(
                    || Table::first(&bound.budget),
                    |flow| Table::around(flow.prices[thing], &bound.budget),
                )
            };
            let values = bound.values(&doors, |thing| table(thing).lists());
            let tables: Vec<(Table, Vec<f64>)> =
                values.into_iter().enumerate().map(|(thing, values)| (table(thing), values)).collect();
            let world = (&bound.clock, &doors);
            flow = Some(Flow::search(&tables, flow, &bound.roads, world, &bound.budget, settings.again));
        }
        if let Some(flow) = flow {
            bound.prices = flow.prices;
            bound.step_price = flow.step_price;
        }
        bound.scale(&doors);
        bound
    }

    /// Scales all prices by the best of some factors; what the robot collects is in proportion to them.
    fn scale(&mut self, doors: &Doors) {
        let collected = self.collected(doors);
        let values = self.values(doors, |thing| {
            FACTORS.map(|factor| self.prices[thing].map(|price| price * factor)).to_vec()
        });
        let bound = |at: usize| values.iter().map(|values| values[at]).sum::<f64>() - FACTORS[at] * collected;
        let best = (0..FACTORS.len()).max_by(|a, b| bound(*a).total_cmp(&bound(*b))).unwrap_or(0);
        self.prices.iter_mut().flatten().for_each(|price| *price *= FACTORS[best]);
        self.step_price *= FACTORS[best];
    }

    /// The bound in the week of a seed: the doors do in it what they do in a [`crate::Patrol`] of this seed. Over many seeds, no
    /// strategy is below the mean of the bounds on average; in a single week it can be by luck. NaN without a thing or a step.
    pub fn brier(&self, seed: u64) -> f64 {
        let steps = self.clock.cell.len();
        let doors = Doors::new(self.building, seed, steps);
        let values = self.values(&doors, |thing| vec![self.prices[thing]]);
        let total = values.iter().map(|values| values[0]).sum::<f64>() - self.collected(&doors);
        total / (self.chains.len() * steps) as f64
    }

    fn values(&self, doors: &Doors, lists: impl Fn(usize) -> Vec<Prices> + Sync) -> Vec<Vec<f64>> {
        let value = |thing: usize| {
            let planner = Planner {
                cells: &self.cells,
                chain: &self.chains[thing],
                access: &doors.access(self.building, &self.cells, thing),
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
            let rules = Rules { step_price: self.step_price * factor, again: self.settings.again };
            let trip = best_trip(&self.roads, &self.prices, stretch, rules, false);
            trip.collected + rules.step_price * self.budget.total
        };
        let factors: &[f64] = if self.budget.is_always { &[0.0] } else { &STEP_PRICE_FACTORS };
        factors.iter().map(collected).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests;

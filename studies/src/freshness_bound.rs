//! A lower bound of the Brier score of a fresh map that no choice of looks falls below on average.
//!
//! The robot knows the habits of all things and not their future, and a look shows the state of one thing. The constraint on
//! the number of looks is replaced by a price per look (Lagrangian dual), so that each thing can be planned alone: by dynamic
//! programming backwards over the steps, with the probability of being blocked as the state. Each look is chosen with all that
//! earlier looks showed. For all prices, the sum of the values of the things minus the price of all permitted looks is a lower
//! bound; the prices that make it largest are searched for.
//!
//! The value is a concave function of the probability: a minimum of functions that are linear or the sum of the concave
//! p (1 − p) and a concave function of a linear one. So linear interpolation between the points of a grid is never
//! above it, and the computed bound remains a bound.
//!
//! Source: Whittle, *Restless bandits: activity allocation in a changing world*, 1988 (relaxation by prices).

pub mod building;

use crate::calendar::{Habit, Law, blocked_probability};
use crate::{Model, STEP_S};
use rayon::prelude::*;

/// Cells of the grid of probabilities.
const CELLS: usize = 256;
/// Search for the best prices: rounds over all classes, and golden sections of each interval.
const ROUNDS: usize = 2;
const SECTIONS: usize = 16;
/// The lowest price that is tried, apart from 0: the sum of Brier scores over steps that a look must take away.
const LOWEST_PRICE: f64 = 1e-4;

/// How many looks there can be. Steps are divided into classes, each with a limit of its own: one class for a limit over the
/// whole time, one class per step where looks cannot be shifted at all. More classes make the bound higher and its
/// computation longer.
#[derive(Clone, Debug, PartialEq)]
pub struct LookLimits {
    class_of_step: Vec<usize>,
    looks: Vec<f64>,
}

impl LookLimits {
    /// One limit of the number of looks in these steps.
    pub fn in_all(steps: usize, looks: f64) -> Self {
        Self { class_of_step: vec![0; steps], looks: vec![looks] }
    }

    /// A number of looks per step, in classes of steps that share a price: the class of each step, from 0 on.
    pub fn per_step(class_of_step: Vec<usize>, looks: f64) -> Self {
        let classes = class_of_step.iter().max().map_or(0, |last| last + 1);
        let mut limits = vec![0.0; classes];
        class_of_step.iter().for_each(|class| limits[*class] += looks);
        Self { class_of_step, looks: limits }
    }
}

/// The lower bound of the mean Brier score over all things and steps, from a Monday, 0:00, on, without earlier looks; NaN
/// without a thing or a step. A look at a thing in a step shows its state before the step is scored. `None` if a thing
/// has stays that are not exponential: its belief is then more than one probability.
pub fn freshness_bound(habits: &[Habit], limits: &LookLimits) -> Option<f64> {
    let mut stays = habits.iter().flat_map(|habit| habit.active.iter().chain(&habit.quiet));
    if stays.any(|stays| stays.long_share != 0.0) {
        return None;
    }
    let things: Vec<Thing> = habits.par_iter().map(|habit| Thing::new(habit, limits)).collect();
    let total = best_prices(limits, |prices| {
        let values: Vec<f64> = things.par_iter().map(|thing| thing.value(limits, prices)).collect();
        values.iter().sum()
    });
    Some(total / (habits.len() * limits.class_of_step.len()) as f64)
}

/// The dual function at the best prices that a search along one price after the other finds.
fn best_prices(limits: &LookLimits, values: impl Fn(&[f64]) -> f64) -> f64 {
    let dual = |prices: &[f64]| {
        let paid: f64 = prices.iter().zip(&limits.looks).map(|(price, looks)| price * looks).sum();
        values(prices) - paid
    };
    // No look takes away more than the largest variance in all steps.
    let highest = (0.25 * limits.class_of_step.len() as f64).max(2.0 * LOWEST_PRICE);
    let ends = [libm::log(LOWEST_PRICE), libm::log(highest)];
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let mut best = vec![0.0; limits.looks.len()];
    let mut bound = dual(&best);
    for _ in 0..ROUNDS {
        for class in 0..best.len() {
            let at = |logarithm: f64| {
                let mut prices = best.clone();
                prices[class] = libm::exp(logarithm);
                let value = dual(&prices);
                (value, prices)
            };
            // The dual function is concave, so along one price it has one peak.
            let [mut low, mut high] = ends;
            let [mut left, mut right] = [high - ratio * (high - low), low + ratio * (high - low)];
            let (mut on_left, mut on_right) = (at(left), at(right));
            for _ in 0..SECTIONS {
                if on_left.0 > on_right.0 {
                    (high, right, on_right) = (right, left, on_left);
                    left = high - ratio * (high - low);
                    on_left = at(left);
                } else {
                    (low, left, on_left) = (left, right, on_right);
                    right = low + ratio * (high - low);
                    on_right = at(right);
                }
            }
            for (value, prices) in [on_left, on_right] {
                if value > bound {
                    (bound, best) = (value, prices);
                }
            }
        }
    }
    bound
}

/// A place on the grid: the cell, and the share of its upper end.
type Place = (usize, f64);

/// A thing with two states.
struct Thing {
    start: Place,
    /// Where each point of the grid is after a step, while the place is quiet and while it is active.
    after: [Vec<Place>; 2],
    is_active: Vec<bool>,
}

impl Thing {
    fn new(habit: &Habit, limits: &LookLimits) -> Self {
        let after = [false, true].map(|is_active| {
            let transitions = habit.transitions(is_active, STEP_S);
            let [free, blocked] = [0, 2].map(|phase| blocked_probability(&transitions[phase]));
            (0..=CELLS).map(|at| place(free + probability(at) * (blocked - free))).collect()
        });
        let steps = 0..limits.class_of_step.len();
        Self {
            start: place(blocked_probability(Model::of(habit).start())),
            after,
            is_active: steps.map(|step| habit.hours.is_active(step as f64 * STEP_S)).collect(),
        }
    }

    /// The smallest expected sum of the Brier scores and the prices of the looks.
    fn value(&self, limits: &LookLimits, prices: &[f64]) -> f64 {
        let variances: Vec<f64> = (0..=CELLS).map(|at| probability(at) * (1.0 - probability(at))).collect();
        let (mut later, mut value) = (vec![0.0; CELLS + 1], vec![0.0; CELLS + 1]);
        for (class, is_active) in limits.class_of_step.iter().zip(&self.is_active).rev() {
            let after = &self.after[usize::from(*is_active)];
            let free = interpolated(&later, after[0]);
            let blocked = interpolated(&later, after[CELLS]);
            for (at, value) in value.iter_mut().enumerate() {
                let no_look = variances[at] + interpolated(&later, after[at]);
                let look = prices[*class] + free + probability(at) * (blocked - free);
                *value = no_look.min(look);
            }
            std::mem::swap(&mut later, &mut value);
        }
        interpolated(&later, self.start)
    }
}

/// A point of the grid, which is finer near 0 and 1, where a thing is after a look.
fn probability(at: usize) -> f64 {
    let share = at as f64 / CELLS as f64;
    share * share * (3.0 - 2.0 * share)
}

fn place(value: f64) -> Place {
    let (mut low, mut high) = (0, CELLS);
    while high - low > 1 {
        let middle = usize::midpoint(low, high);
        if probability(middle) <= value { low = middle } else { high = middle }
    }
    (low, ((value - probability(low)) / (probability(high) - probability(low))).clamp(0.0, 1.0))
}

fn interpolated(values: &[f64], (cell, share): Place) -> f64 {
    values[cell] + share * (values[cell + 1] - values[cell])
}

#[cfg(test)]
mod tests;

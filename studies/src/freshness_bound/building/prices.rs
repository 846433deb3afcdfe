use super::doors::Doors;
use super::plan::Prices;
use super::roads::Roads;
use super::trips::{Clock, Rules, best_trip};
use crate::Duty;

/// The prices at which things are planned at first, and multiples of the prices that were found, at which they are planned
/// then.
const FIRST: [f64; 6] = [0.2, 1.0, 5.0, 25.0, 125.0, 625.0];
const MULTIPLES: [f64; 4] = [0.25, 0.7, 1.5, 4.0];
const MIDDLE: f64 = 25.0;
/// The search for prices goes through the whole time this often, in trips of at most some steps, without and with a battery.
const PASSES: usize = 3;
/// It is at least this long.
const ROUNDS: usize = 100;
const TRIPS: [usize; 2] = [360, 1800];
/// A trip with too many steps raises the price of a step by at most this factor, in the logarithm.
const STEP_PRICE_GAIN: f64 = 0.2;
/// The first price of a step, where there is a battery.
const STEP_PRICE: f64 = 5.0;

/// The prices at which a thing is planned. Without a battery: of each class of hours alone, with the other at a middle price.
/// With a battery the robot chooses the hours, and a look has the same price in all.
pub(super) struct Table {
    grids: Vec<Vec<f64>>,
    middle: Prices,
}

impl Table {
    pub(super) fn first(budget: &Budget) -> Self {
        let scale = if budget.is_always { 1.0 } else { 3.0 };
        let grid = FIRST.iter().map(|price| scale * price).collect();
        Self { grids: vec![grid; budget.classes()], middle: [MIDDLE; 2] }
    }

    /// Around prices that were found.
    pub(super) fn around(prices: Prices, budget: &Budget) -> Self {
        let grid = |price: &f64| MULTIPLES.iter().map(|multiple| multiple * price.max(1e-3)).collect();
        Self { grids: prices[..budget.classes()].iter().map(grid).collect(), middle: prices }
    }

    pub(super) fn lists(&self) -> Vec<Prices> {
        match &self.grids[..] {
            [quiet, active] => {
                let quiet = quiet.iter().map(|price| [*price, self.middle[1]]);
                quiet.chain(active.iter().map(|price| [self.middle[0], *price])).collect()
            }
            all => all.iter().flatten().map(|price| [*price; 2]).collect(),
        }
    }

    /// How many looks the thing chooses, from its values at the prices.
    fn demands(&self, values: &[f64]) -> Vec<Demand> {
        let mut left = values;
        let demand = |grid: &Vec<f64>| {
            let (values, rest) = left.split_at(grid.len());
            left = rest;
            Demand::new(grid, values)
        };
        self.grids.iter().map(demand).collect()
    }
}

/// The prices at which a thing would choose this number of looks.
fn prices_of(demands: &[Demand], looks: &Prices) -> Prices {
    match demands {
        [quiet, active] => [quiet.price(looks[0]), active.price(looks[1])],
        all => [all[0].price(looks[0] + looks[1]); 2],
    }
}

/// How many steps outside the dock there can be.
pub(super) struct Budget {
    pub(super) is_always: bool,
    pub(super) total: f64,
}

impl Budget {
    pub(super) fn new(steps: usize, duty: Duty) -> Self {
        Self { is_always: duty.is_always(), total: steps as f64 / duty.spread() }
    }

    /// Classes of hours with prices of their own.
    fn classes(&self) -> usize {
        if self.is_always { 2 } else { 1 }
    }
}

/// Prices, found by a search for the best mixture of trips (Frank and Wolfe): the looks of a mixture have prices at which
/// each thing would choose as many, and the trip that collects most at these prices gets a larger share.
pub(super) struct Flow {
    pub(super) prices: Vec<Prices>,
    pub(super) step_price: f64,
    looks: Vec<Prices>,
}

impl Flow {
    /// Starts from a flow, if there is one.
    pub(super) fn search(
        tables: &[(Table, Vec<f64>)],
        start: Option<Self>,
        roads: &Roads,
        (clock, doors): (&Clock, &Doors),
        budget: &Budget,
        again: f64,
    ) -> Self {
        let demands: Vec<Vec<Demand>> = tables.iter().map(|(table, values)| table.demands(values)).collect();
        let steps = clock.cell.len();
        let trips = steps.div_ceil(TRIPS[usize::from(!budget.is_always)]);
        let rounds = (PASSES * trips).max(ROUNDS);
        let first = if start.is_some() { rounds / PASSES } else { 0 };
        let guess = || Self {
            prices: Vec::new(),
            looks: vec![[1.0; 2]; tables.len()],
            step_price: if budget.is_always { 0.0 } else { STEP_PRICE },
        };
        let Self { mut prices, mut looks, mut step_price } = start.unwrap_or_else(guess);
        for round in first..rounds {
            prices = demands.iter().zip(&looks).map(|(demands, looks)| prices_of(demands, looks)).collect();
            let trip = order(round, trips);
            let range = trip * steps / trips..(trip + 1) * steps / trips;
            let weight = 2.0 / (round as f64 + 2.0);
            let share = range.len() as f64 / steps as f64;
            let rules = Rules { step_price, again };
            let trip = best_trip(roads, &prices, clock.stretch(range, doors), rules, true);
            let excess = trip.steps as f64 / (budget.total * share) - 1.0;
            step_price *= libm::exp(STEP_PRICE_GAIN * weight.sqrt() * excess.min(3.0));
            for (looks, more) in looks.iter_mut().zip(&trip.looks) {
                (0..2).for_each(|class| looks[class] += weight * (more[class] / share - looks[class]));
            }
        }
        Self { prices, looks, step_price }
    }
}

/// Trips in an order that mixes the times of the week.
fn order(round: usize, trips: usize) -> usize {
    let is_coprime = |stride: &usize| {
        (2..=*stride).all(|factor| !(stride.is_multiple_of(factor) && trips.is_multiple_of(factor)))
    };
    let stride = (trips * 2 / 5 + 1..trips.max(2) * 2).find(is_coprime).unwrap_or(1);
    round * stride % trips
}

/// How many looks a thing chooses at a price: the slope of its value.
struct Demand {
    /// The logarithms of the number of looks, falling, and of the price.
    points: Vec<[f64; 2]>,
}

impl Demand {
    fn new(grid: &[f64], values: &[f64]) -> Self {
        let slope = |at: usize| (values[at + 1] - values[at]) / (grid[at + 1] - grid[at]);
        let point = |at: usize| [libm::log(slope(at).max(1e-9)), 0.5 * libm::log(grid[at] * grid[at + 1])];
        Self { points: (0..grid.len() - 1).map(point).collect() }
    }

    /// Interpolated, and extrapolated a little.
    fn price(&self, looks: f64) -> f64 {
        let looks = libm::log(looks.max(1e-9));
        let pairs = self.points.windows(2);
        let last = pairs.len().saturating_sub(1);
        let pair = pairs.enumerate().find(|(at, pair)| *at == last || pair[1][0] <= looks);
        pair.map_or(f64::NAN, |(_, pair)| {
            let share = (pair[0][0] - looks) / (pair[0][0] - pair[1][0]).max(1e-3);
            libm::exp(pair[0][1] + share.clamp(-2.0, 2.0) * (pair[1][1] - pair[0][1]))
        })
    }
}

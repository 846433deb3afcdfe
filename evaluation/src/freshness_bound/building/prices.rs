use super::doors::Doors;
use super::plan::Prices;
use super::roads::{Clock, Roads, Rules};
use days::Duty;

/// The prices at which things are planned at first: each class of hours alone, with the others at a middle price.
const GRID: [f64; 6] = [0.2, 1.0, 5.0, 25.0, 125.0, 625.0];
const MIDDLE: usize = 3;
/// The search for prices goes through the whole time this often, in trips of at most some steps, without and with a battery.
const PASSES: usize = 3;
const TRIPS: [usize; 2] = [360, 1800];
/// A trip with too many steps raises the price of a step by at most this factor, in the logarithm.
const STEP_PRICE_GAIN: f64 = 0.1;

/// The prices at which things are planned at first: those of quiet hours, then those of active ones.
pub(super) fn table() -> Vec<Prices> {
    let quiet = GRID.map(|price| [price, GRID[MIDDLE]]);
    let active = GRID.map(|price| [GRID[MIDDLE], price]);
    [quiet, active].concat()
}

/// How many steps outside the dock there can be.
pub(super) struct Budget {
    pub(super) is_always: bool,
    /// In all.
    total: f64,
    /// In quiet and in active hours: at most what is left after never moving in the others.
    limits: [f64; 2],
}

impl Budget {
    pub(super) fn new(is_active: &[bool], duty: Duty) -> Self {
        let steps = is_active.len() as f64;
        let limits = [false, true].map(|active| limit(is_active, active, duty));
        let is_always = duty.is_always();
        Self {
            is_always,
            total: if is_always { steps } else { steps / duty.spread() },
            limits,
        }
    }

    /// The price of all permitted steps.
    pub(super) fn cost(&self, step: Prices) -> f64 {
        let base = step[0].min(step[1]);
        base * self.total + (0..2).map(|class| (step[class] - base) * self.limits[class]).sum::<f64>()
    }
}

/// The steps outside the dock in such hours, if the robot rests in the others: the battery is then as full as it can be.
fn limit(is_active: &[bool], active: bool, duty: Duty) -> f64 {
    if duty.is_always() {
        return is_active.iter().filter(|is_active| **is_active == active).count() as f64;
    }
    let (mut charge, mut used) = (0.0, 0.0);
    for is_active in is_active {
        if *is_active == active {
            // A part of the step is used, and charges in the other part; with what is left from before.
            let part = (charge + duty.charge_per_step()).min(1.0 + duty.charge_per_step())
                / (1.0 + duty.charge_per_step());
            used += part;
            charge += (1.0 - part) * duty.charge_per_step() - part;
        } else {
            charge = (charge + duty.charge_per_step()).min(duty.full_steps());
        }
    }
    used
}

/// Prices, found by a search for the best mixture of trips (Frank and Wolfe): the looks of a mixture have prices at which
/// each thing would choose as many, and the trip that collects most at these prices gets a larger share.
pub(super) struct Flow {
    pub(super) prices: Vec<Prices>,
    pub(super) step: Prices,
    pub(super) looks: Vec<Prices>,
}

impl Flow {
    pub(super) fn search(
        table: &[Vec<f64>],
        roads: &Roads,
        (clock, doors): (&Clock, &Doors),
        budget: &Budget,
        again: f64,
    ) -> Self {
        let demands: Vec<[Demand; 2]> =
            table.iter().map(|values| [0, 1].map(|class| Demand::new(&values[class * GRID.len()..]))).collect();
        let steps = clock.cell.len();
        let trips = steps.div_ceil(TRIPS[usize::from(!budget.is_always)]);
        let mut looks = vec![[1.0; 2]; table.len()];
        let mut step_price = if budget.is_always { 0.0 } else { 5.0 };
        let mut prices = Vec::new();
        for round in 0..PASSES * trips {
            let price = |(demand, looks): (&[Demand; 2], &Prices)| [0, 1].map(|class| demand[class].price(looks[class]));
            prices = demands.iter().zip(&looks).map(price).collect();
            let trip = order(round, trips);
            let range = trip * steps / trips..(trip + 1) * steps / trips;
            let weight = 2.0 / (round as f64 + 2.0);
            let share = range.len() as f64 / steps as f64;
            let rules = Rules { step: [step_price; 2], again };
            let trip = roads.best_trip(&prices, clock.stretch(range, doors), rules, true);
            let excess = trip.steps as f64 / (budget.total * share) - 1.0;
            step_price *= libm::exp(STEP_PRICE_GAIN * weight.sqrt() * excess.min(3.0));
            for (looks, more) in looks.iter_mut().zip(&trip.looks) {
                (0..2).for_each(|class| looks[class] += weight * (more[class] / share - looks[class]));
            }
        }
        Self { prices, step: [step_price; 2], looks }
    }
}

/// Trips in an order that mixes the times of the week.
fn order(round: usize, trips: usize) -> usize {
    let is_coprime = |stride: &usize| (2..=*stride).all(|factor| !(stride.is_multiple_of(factor) && trips.is_multiple_of(factor)));
    let stride = (trips * 2 / 5 + 1..trips.max(2) * 2).find(is_coprime).unwrap_or(1);
    round * stride % trips
}

/// How many looks a thing chooses at a price: the slope of its value.
struct Demand {
    /// The logarithms of the number of looks, falling, and of the price.
    points: Vec<[f64; 2]>,
}

impl Demand {
    fn new(values: &[f64]) -> Self {
        let slope = |at: usize| (values[at + 1] - values[at]) / (GRID[at + 1] - GRID[at]);
        let point = |at: usize| [libm::log(slope(at).max(1e-9)), 0.5 * libm::log(GRID[at] * GRID[at + 1])];
        Self { points: (0..GRID.len() - 1).map(point).collect() }
    }

    fn price(&self, looks: f64) -> f64 {
        let looks = libm::log(looks.max(1e-9));
        let (first, last) = (self.points[0], self.points[self.points.len() - 1]);
        if looks >= first[0] {
            return libm::exp(first[1]) * libm::exp(-2.0 * (looks - first[0]));
        }
        let pair = self.points.windows(2).find(|pair| pair[1][0] <= looks);
        libm::exp(pair.map_or(last[1], |pair| {
            let share = (pair[0][0] - looks) / (pair[0][0] - pair[1][0]).max(1e-12);
            pair[0][1] + share.min(1.0) * (pair[1][1] - pair[0][1])
        }))
    }
}

//! How well the robot knows the things that come and go while it is elsewhere, per thing with one place: the Brier score of “it is
//! there”, beside that of the nominal chain of the world after the same looks, and that of a posterior that knows which cells are which
//! thing (the floor). A look is a reading with one of its cells in view; the world is compared with the readings once per second.

use crate::metrics::Mean;
use crate::scheduled_things::{object_cell, presence};
use mapper::{Evidence, Mapper, Population, Posterior};
use serde::{Deserialize, Serialize};
use sim::physics::{self, PhysicsWorld};

/// The horizons, s.
const AHEAD_S: [f64; 3] = [0.0, 60.0, 600.0];
/// The times between looks, between forecasts, and from learning the population of the floor to learning it anew, s.
const LOOK_S: f64 = 1.0;
const EVERY_S: f64 = 15.0;
const POPULATION_S: f64 = 300.0;
const HOUR_S: f64 = 3600.0;
/// What comes less often than once in this time stays away for good, and has no rate, s.
const LONGEST_CYCLE_S: f64 = 1e7;

/// A number for each of the four that predict: the map, the nominal chain, the floor, and the state last seen.
type OfEach = [f64; 4];

/// Compares what the map says of things with the truth.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct KnownThings {
    /// The times at which a look, forecasts, and learning the population are due, s.
    due_s: [f64; 3],
    population: Population,
    states: Vec<State>,
    /// Follows from the world.
    #[serde(skip)]
    things: Option<Vec<physics::Thing>>,
}

/// What the looks at a thing say, and the scores of the forecasts so far.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
struct State {
    evidence: Evidence,
    /// The time of the last look, s, and whether the thing was there.
    last: Option<(f64, bool)>,
    /// The time of the last sample, s, and the probability that the thing is there by its nominal chain.
    nominal: (f64, f64),
    /// For each horizon the forecasts that are not due: when they are, s, whether they were made in the first hour, and the probabilities.
    open: [Vec<(f64, bool, OfEach)>; 3],
    /// For each horizon the sums and numbers of the squared errors over the run, and of those forecasts made in the first hour.
    sums: [[(OfEach, f64); 2]; 3],
    /// Follows from the evidence.
    #[serde(skip)]
    floor: Option<Posterior>,
}

/// The scores of one thing.
#[derive(Clone, Debug)]
pub struct KnownThing {
    brier: [[Option<OfEach>; 2]; 3],
    /// Of a thing with a rate: the log errors of the map's and of the floor's, and whether their 90 % intervals hold it.
    rates: Option<([f64; 2], [bool; 2])>,
    is_object: bool,
}

/// Brier scores at a horizon.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ThingBrier {
    /// The mean over all things of the mean of (probability of being there − truth)².
    pub brier: f64,
    /// This divided by that of the nominal chain of the world.
    pub by_nominal: f64,
    /// This divided by that of the floor.
    pub by_floor: f64,
    /// The Brier score of the state last seen, divided by that of the nominal chain.
    pub last_seen_by_nominal: f64,
}

/// Brier scores at all horizons.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ThingBriers {
    /// When the forecast is made.
    pub now: Option<ThingBrier>,
    /// One minute later.
    pub in_1min: Option<ThingBrier>,
    /// Ten minutes later.
    pub in_10min: Option<ThingBrier>,
}

/// How well the robot knows the things with one place that were seen at least once.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct KnownThingsScores {
    /// The number of things.
    pub things: usize,
    /// The number of these that the map knows as objects.
    pub objects: usize,
    /// The scores of all forecasts.
    #[serde(flatten)]
    pub all: ThingBriers,
    /// Those of the forecasts that were made in the first hour.
    pub first_hour: ThingBriers,
    /// The mean log error of the cycle rates of things that come and go, at most ln 10 each; of the map and of the floor.
    pub log_error: [Option<f64>; 2],
    /// The share of these rates in the 90 % interval of the map, and of the floor.
    pub inside_90: [Option<f64>; 2],
}

impl KnownThings {
    /// Compares the map with the world if that is due.
    pub fn sample(&mut self, world: &PhysicsWorld, mapper: &Mapper) {
        let time_s = world.time_s();
        let since_s = (time_s - mapper.time()).max(0.0);
        let is_due = self.due_s.map(|due_s| time_s + 1e-6 >= due_s);
        let things = self.things.get_or_insert_with(|| things_of(world));
        if !is_due[0] || things.is_empty() {
            return;
        }
        for (due_s, (every_s, is_due)) in
            self.due_s.iter_mut().zip([LOOK_S, EVERY_S, POPULATION_S].into_iter().zip(is_due))
        {
            *due_s = if is_due { time_s + every_s } else { *due_s };
        }
        self.states.resize_with(things.len(), State::default);
        if is_due[2] {
            let alone =
                self.states.iter().map(|state| Posterior::new(&state.evidence, &Population::default()));
            self.population = Population::of(alone.collect::<Vec<_>>().iter());
            self.states.iter_mut().for_each(|state| state.floor = None);
        }
        for (thing, state) in things.iter().zip(&mut self.states) {
            let is_there = world.fleet().place_of(thing).is_some();
            let rates = nominal(thing, world);
            state.score(time_s, is_there);
            state.age(time_s, rates);
            let is_reading = since_s < LOOK_S;
            if is_reading && thing.places[0].iter().any(|cell| mapper.is_in_view(*cell)) {
                state.look(time_s, is_there);
            }
            if let (true, Some(rates)) = (is_due[1], rates) {
                let map = |ahead_s: f64| presence(mapper, &thing.places[0], since_s + ahead_s);
                state.forecast(time_s, rates, &self.population, map);
            }
        }
    }

    /// The scores of each thing that was seen.
    pub fn rows(&self, world: &PhysicsWorld, mapper: &Mapper) -> Vec<KnownThing> {
        let row = |(thing, state): (&physics::Thing, &State)| {
            state.last?;
            let [come, go] = nominal(thing, world)?;
            let (rate, cells) = (come * go / (come + go), &thing.places[0]);
            let object = object_cell(mapper, cells);
            let changed = || cells.iter().copied().find(|cell| mapper.statistics(*cell).events() > 0);
            let cell = object.or_else(changed).or(cells.first().copied());
            let floor = Posterior::new(&state.evidence, &self.population);
            let error = |found: f64| (found / rate).ln().abs().min(10f64.ln());
            let holds = |(low, high): (f64, f64)| (low..=high).contains(&rate);
            let rates = || {
                let errors = [error(cell.map_or(0.0, |cell| mapper.rate(cell))), error(floor.cycle_rate())];
                let holds_map = cell.is_some_and(|cell| holds(mapper.credible_interval(cell, 0.9)));
                (errors, [holds_map, holds(floor.interval(0.9))])
            };
            let brier = state
                .sums
                .map(|sums| sums.map(|(sums, count)| (count > 0.0).then(|| sums.map(|sum| sum / count))));
            let has_rate = rate * LONGEST_CYCLE_S > 1.0;
            Some(KnownThing { brier, rates: has_rate.then(rates), is_object: object.is_some() })
        };
        self.things.iter().flatten().zip(&self.states).filter_map(row).collect()
    }
}

impl KnownThingsScores {
    /// The means over things; `None` without any.
    pub fn of(rows: &[KnownThing]) -> Option<Self> {
        let briers = |part: usize| {
            let at = |horizon: usize| {
                let all: Vec<OfEach> = rows.iter().filter_map(|row| row.brier[horizon][part]).collect();
                let mean = |who: usize| mean(all.iter().map(|brier| brier[who]));
                let (brier, nominal) = (mean(0)?, mean(1)?);
                let (by_nominal, by_floor) = (brier / nominal, brier / mean(2)?);
                Some(ThingBrier { brier, by_nominal, by_floor, last_seen_by_nominal: mean(3)? / nominal })
            };
            ThingBriers { now: at(0), in_1min: at(1), in_10min: at(2) }
        };
        let rates = || rows.iter().filter_map(|row| row.rates);
        (!rows.is_empty()).then(|| Self {
            things: rows.len(),
            objects: rows.iter().filter(|row| row.is_object).count(),
            all: briers(0),
            first_hour: briers(1),
            log_error: [0, 1].map(|who| mean(rates().map(|(errors, _)| errors[who]))),
            inside_90: [0, 1].map(|who| mean(rates().map(|(_, inside)| f64::from(u8::from(inside[who]))))),
        })
    }
}

impl State {
    fn score(&mut self, time_s: f64, is_there: bool) {
        for (open, sums) in self.open.iter_mut().zip(&mut self.sums) {
            for (_, is_early, predicted) in open.extract_if(.., |(due_s, ..)| *due_s <= time_s) {
                for (sums, count) in &mut sums[..=usize::from(is_early)] {
                    *count += 1.0;
                    let errors =
                        predicted.map(|predicted| (predicted - f64::from(u8::from(is_there))).powi(2));
                    sums.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error);
                }
            }
        }
    }

    /// The nominal chain goes on: its rates can change with the hour.
    fn age(&mut self, time_s: f64, rates: Option<[f64; 2]>) {
        let (before_s, was_there) = self.nominal;
        self.nominal = (time_s, rates.map_or(was_there, |rates| later(rates, was_there, time_s - before_s)));
    }

    fn look(&mut self, time_s: f64, is_there: bool) {
        self.nominal.1 = f64::from(u8::from(is_there));
        let Some((last_s, was_there)) = self.last.replace((time_s, is_there)) else { return };
        self.floor = None;
        self.evidence.look(was_there, is_there, time_s - last_s);
    }

    fn forecast(&mut self, time_s: f64, rates: [f64; 2], population: &Population, map: impl Fn(f64) -> f64) {
        let Some((last_s, was_there)) = self.last else { return };
        let floor = self.floor.get_or_insert_with(|| Posterior::new(&self.evidence, population));
        for (open, ahead_s) in self.open.iter_mut().zip(AHEAD_S) {
            let (elapsed_s, last) = (time_s - last_s + ahead_s, f64::from(u8::from(was_there)));
            let nominal = later(rates, self.nominal.1, ahead_s);
            let predicted = [map(ahead_s), nominal, floor.probability(was_there, elapsed_s), last];
            open.push((time_s + ahead_s, time_s < HOUR_S, predicted));
        }
    }
}

fn things_of(world: &PhysicsWorld) -> Vec<physics::Thing> {
    let all = world.spec().things().into_iter();
    all.filter(|thing| thing.places.len() == 1 && nominal(thing, world).is_some()).collect()
}

/// The nominal rates of coming and going, 1/s.
fn nominal(thing: &physics::Thing, world: &PhysicsWorld) -> Option<[f64; 2]> {
    Some(thing.mean_stays_s(world.spec(), world.time_s())?.map(|stay_s| 1.0 / stay_s))
}

/// The probability that a thing is there, this much time after it was there with another one, s.
fn later([come, go]: [f64; 2], probability: f64, time_s: f64) -> f64 {
    let share = come / (come + go);
    share + (probability - share) * (-(come + go) * time_s).exp()
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut mean = Mean::default();
    values.for_each(|value| mean.add(value));
    mean.get()
}

//! How well a robot knows things that come and go while it is elsewhere, per thing with one place: the Brier score of “it is there” now,
//! 1 and 10 minutes ahead, divided by that of the nominal chain of the world after the same looks, and by that of a posterior that
//! knows which cells are which thing (the floor); the log error of cycle rates, and the share inside 90 % intervals. Means over the
//! things that were seen, from the first look at each on; a look is a reading with one of its cells in view. A line per world with the
//! seed 1, and one for all; the last number of each horizon is the state last seen, divided by the nominal chain.
//!
//! ```text
//! cargo run -p curious-evaluation --example behind_back -- MINUTES WORLD..
//! cargo run -p curious-evaluation --example behind_back -- 120 rooms-1 rooms-2
//! ```

use agent::Policy;
use evaluation::physics_trial::{self, PhysicsTrial};
use evaluation::scheduled_things::{object_cell, presence};
use mapper::{Evidence, Population, Posterior};
use sim::physics::{self, WorldSpec};
use std::error::Error;

const AHEAD_S: [f64; 3] = [0.0, 60.0, 600.0];
const EVERY_S: f64 = 15.0;
/// The thing is in view between two looks that are at most this far apart, s.
const MAX_GAP_S: f64 = 2.5;

/// A forecast: when it is due, s, and the probabilities by the map, the nominal chain, the floor, and the last look.
type Forecast = (f64, [f64; 4]);

struct Thing {
    thing: physics::Thing,
    evidence: Evidence,
    last: Option<(f64, bool)>,
    /// For each horizon the forecasts that are not due, and the sums of their squared errors and their number so far.
    open: [Vec<Forecast>; 3],
    sums: [([f64; 4], f64); 3],
}

/// The scores of a thing: of each horizon the Brier scores; of the map and of the floor the log error of the rate, and whether the
/// interval holds it; whether the map knows the thing as an object.
struct Row {
    brier: [Option<[f64; 4]>; 3],
    errors: [f64; 2],
    inside: [bool; 2],
    is_found: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [minutes, worlds @ ..] = &arguments[..] else {
        return Err("usage: behind_back MINUTES WORLD..".into());
    };
    let end_s = 60.0 * minutes.parse::<f64>()?;
    let mut all = Vec::new();
    for world in worlds {
        let rows = run(&worldfile::shipped::load(world)?, end_s)?;
        report(world, &rows);
        all.extend(rows);
    }
    report("all", &all);
    Ok(())
}

fn run(spec: &WorldSpec, end_s: f64) -> Result<Vec<Row>, Box<dyn Error>> {
    let settings = physics_trial::settings(spec)?;
    let pilot = settings.pilot(settings.agent(&Policy::default(), 1)?, 1)?;
    let mut trial = PhysicsTrial::new(spec, 1, &settings, None, pilot)?;
    let single = spec.things().into_iter().filter(|thing| thing.places.len() == 1);
    let mut things: Vec<Thing> = single.map(Thing::new).collect();
    let mut due_s = 60.0;
    loop {
        let time_s = trial.turn()?.reading.time_s;
        let mapper = &trial.robot.mapper;
        for thing in &mut things {
            let is_there = trial.world.fleet().place_of(&thing.thing).is_some();
            thing.score(time_s, is_there);
            if thing.cells().iter().any(|cell| mapper.is_in_view(*cell)) {
                thing.look(time_s, is_there);
            }
        }
        if time_s >= due_s {
            due_s += EVERY_S;
            let floors = floors(&things);
            for (thing, floor) in things.iter_mut().zip(floors) {
                let Some((last_s, was_there)) = thing.last else { continue };
                let Some([come, go]) = thing.rates(spec, time_s) else { continue };
                for (horizon, ahead_s) in AHEAD_S.into_iter().enumerate() {
                    let (elapsed_s, last) = (time_s - last_s + ahead_s, f64::from(u8::from(was_there)));
                    let share = come / (come + go);
                    let nominal = share + (last - share) * (-(come + go) * elapsed_s).exp();
                    let own = presence(mapper, thing.cells(), ahead_s);
                    let predicted = [own, nominal, floor.probability(was_there, elapsed_s), last];
                    thing.open[horizon].push((time_s + ahead_s, predicted));
                }
            }
        }
        if time_s >= end_s {
            break;
        }
    }
    let mapper = &trial.robot.mapper;
    let intervals = mapper.credible_intervals(0.9);
    let row = |(thing, floor): (&Thing, Posterior)| {
        thing.last?;
        let [come, go] = thing.rates(spec, 0.0)?;
        let nominal = come * go / (come + go);
        let changed = || mapper.changed().find(|cell| thing.cells().contains(cell));
        let object = object_cell(mapper, thing.cells());
        let cell = object.or_else(changed);
        let error = |rate: f64| (rate / nominal).ln().abs().min(10f64.ln());
        let holds = |(low, high): (f64, f64)| (low..=high).contains(&nominal);
        Some(Row {
            brier: thing.sums.map(|(sums, count)| (count > 0.0).then(|| sums.map(|sum| sum / count))),
            errors: [error(cell.map_or(0.0, |cell| mapper.rate(cell))), error(floor.cycle_rate())],
            inside: [cell.is_some_and(|cell| holds(intervals(cell))), holds(floor.interval(0.9))],
            is_found: object.is_some(),
        })
    };
    Ok(things.iter().zip(floors(&things)).filter_map(row).collect())
}

/// What is known of each thing by its own looks, and by those at the others.
fn floors(things: &[Thing]) -> Vec<Posterior> {
    let shipped = Population::default();
    let alone: Vec<Posterior> =
        things.iter().map(|thing| Posterior::new(&thing.evidence, &shipped)).collect();
    let floor = |(number, thing): (usize, &Thing)| {
        let others = alone.iter().enumerate().filter(|(other, _)| *other != number);
        Posterior::new(&thing.evidence, &Population::of(others.map(|(_, posterior)| posterior)))
    };
    things.iter().enumerate().map(floor).collect()
}

impl Thing {
    fn new(thing: physics::Thing) -> Self {
        let (evidence, open, sums) = (Evidence::default(), Default::default(), Default::default());
        Self { thing, evidence, last: None, open, sums }
    }

    fn cells(&self) -> &[usize] {
        &self.thing.places[0]
    }

    /// The nominal rates of coming and going, 1/s.
    fn rates(&self, spec: &WorldSpec, time_s: f64) -> Option<[f64; 2]> {
        Some(self.thing.mean_stays_s(spec, time_s)?.map(|stay_s| 1.0 / stay_s))
    }

    fn score(&mut self, time_s: f64, is_there: bool) {
        for (open, (sums, count)) in self.open.iter_mut().zip(&mut self.sums) {
            for (_, predicted) in open.extract_if(.., |(due_s, _)| *due_s <= time_s) {
                *count += 1.0;
                for (sum, predicted) in sums.iter_mut().zip(predicted) {
                    *sum += (predicted - f64::from(u8::from(is_there))).powi(2);
                }
            }
        }
    }

    fn look(&mut self, time_s: f64, is_there: bool) {
        let Some((last_s, was_there)) = self.last.replace((time_s, is_there)) else { return };
        if time_s - last_s > MAX_GAP_S {
            return self.evidence.gap(was_there, is_there, time_s - last_s);
        }
        self.evidence.watch(was_there, time_s - last_s);
        if is_there != was_there {
            self.evidence.change(was_there);
        }
    }
}

fn report(name: &str, rows: &[Row]) {
    let found = rows.iter().filter(|row| row.is_found).count();
    let mut line = format!("{name}: {} things, found {found}", rows.len());
    for (horizon, ahead_s) in AHEAD_S.into_iter().enumerate() {
        let briers: Vec<[f64; 4]> = rows.iter().filter_map(|row| row.brier[horizon]).collect();
        let mean = |who: usize| briers.iter().map(|brier| brier[who]).sum::<f64>() / briers.len() as f64;
        let [ours, nominal, floor, last] = [0, 1, 2, 3].map(mean);
        let [by_nominal, by_floor, last] = [ours / nominal, ours / floor, last / nominal];
        line += &format!(
            "; {ahead_s:.0} s: {ours:.4} ÷ nominal {by_nominal:.3} ÷ floor {by_floor:.3} ({last:.3})"
        );
    }
    let count = rows.len() as f64;
    for (who, name) in ["map", "floor"].into_iter().enumerate() {
        let error = rows.iter().map(|row| row.errors[who]).sum::<f64>() / count;
        let inside = rows.iter().filter(|row| row.inside[who]).count() as f64 / count;
        line += &format!("; {name}: log error {error:.3}, inside {inside:.3}");
    }
    println!("{line}");
}

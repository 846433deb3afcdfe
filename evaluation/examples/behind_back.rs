//! How well a robot knows things that come and go while it is elsewhere, per thing: the Brier score of “it is there” now, 1 and 10
//! minutes ahead, divided by that of the nominal chain of the world file after the same looks, and by that of a posterior that knows
//! which cells are which thing (the floor); the log error of cycle rates, and the share inside 90 % intervals.
//!
//! ```text
//! cargo run -p curious-evaluation --example behind_back -- MINUTES WORLD.toml..
//! ```

use agent::Policy;
use calendar::Changes;
use evaluation::physics_trial::{self, PhysicsTrial};
use interfaces::{CellState, GroundTruth, TrueState};
use mapper::{Evidence, Mapper, Population, Posterior};
use nalgebra::Point2;
use sim::physics::WorldSpec;
use std::error::Error;

const AHEAD_S: [f64; 3] = [0.0, 60.0, 600.0];
const EVERY_S: f64 = 15.0;
const MAX_GAP_S: f64 = 2.5;
const WHO: [&str; 4] = ["ours", "nominal", "floor", "last seen"];

struct Thing {
    name: String,
    cells: Vec<usize>,
    center: usize,
    /// Nominal rates of coming and going, 1/s.
    rates: [f64; 2],
    evidence: Evidence,
    last: Option<(f64, bool)>,
    looks: u32,
    /// For each horizon the forecasts that are not due: time, predictions.
    open: [Vec<(f64, [f64; 4])>; 3],
    sums: [[f64; 4]; 3],
    counts: [f64; 3],
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [minutes, worlds @ ..] = &arguments[..] else {
        return Err("usage: behind_back MINUTES WORLD..".into());
    };
    let end_s = 60.0 * minutes.parse::<f64>()?;
    let mut all = Vec::new();
    for world in worlds {
        let spec = worldfile::shipped::load(world)?;
        let rows = run(&spec, 1, end_s)?;
        report(world, &rows);
        all.extend(rows);
    }
    report("all", &all);
    Ok(())
}

/// A thing's Brier scores by horizon and predictor, with log errors of ours and the floor, whether the intervals hold the truth, and
/// whether it was found.
struct Row {
    brier: [Option<[f64; 4]>; 3],
    errors: [f64; 2],
    inside: [bool; 2],
    is_found: bool,
}

fn run(spec: &WorldSpec, seed: u64, end_s: f64) -> Result<Vec<Row>, Box<dyn Error>> {
    let settings = physics_trial::settings(spec)?;
    let pilot = settings.pilot(settings.agent(&Policy::default(), seed)?, seed)?;
    let mut trial = PhysicsTrial::new(spec, seed, &settings, None, pilot)?;
    let mut things = things_of(spec);
    let mut due_s = 60.0;
    loop {
        let time_s = trial.turn()?.reading.time_s;
        let (mapper, truth) = (&trial.robot.mapper, trial.world.truth());
        for thing in &mut things {
            let is_there = truth.state(thing.center) != TrueState::Free;
            for (horizon, open) in thing.open.iter_mut().enumerate() {
                while open.first().is_some_and(|(at_s, _)| *at_s <= time_s) {
                    let (_, predicted) = open.remove(0);
                    let is = f64::from(u8::from(is_there));
                    (0..4).for_each(|who| thing.sums[horizon][who] += (predicted[who] - is).powi(2));
                    thing.counts[horizon] += 1.0;
                }
            }
            if thing.cells.iter().any(|cell| mapper.is_in_view(*cell)) {
                thing.look(time_s, is_there);
            }
        }
        if time_s >= due_s {
            due_s += EVERY_S;
            let alone: Vec<Posterior> =
                things.iter().map(|thing| Posterior::new(&thing.evidence, &Population::default())).collect();
            for number in 0..things.len() {
                let others = alone.iter().enumerate().filter(|(other, _)| *other != number);
                let floor = Posterior::new(&things[number].evidence, &Population::of(others.map(|(_, p)| p)));
                let thing = &mut things[number];
                let Some((last_s, was_there)) = thing.last else { continue };
                for (horizon, ahead_s) in AHEAD_S.into_iter().enumerate() {
                    let elapsed_s = time_s - last_s + ahead_s;
                    let last = f64::from(u8::from(was_there));
                    let [come, go] = thing.rates;
                    let share = come / (come + go);
                    let nominal = share + (last - share) * (-(come + go) * elapsed_s).exp();
                    let predicted = [
                        thing.predicted(mapper, ahead_s),
                        nominal,
                        floor.probability(was_there, elapsed_s),
                        last,
                    ];
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
    let alone: Vec<Posterior> =
        things.iter().map(|thing| Posterior::new(&thing.evidence, &Population::default())).collect();
    let mut rows = Vec::new();
    for (number, thing) in things.iter().enumerate().filter(|(_, thing)| thing.last.is_some()) {
        let others = alone.iter().enumerate().filter(|(other, _)| *other != number);
        let floor = Posterior::new(&thing.evidence, &Population::of(others.map(|(_, p)| p)));
        let [come, go] = thing.rates;
        let nominal = come * go / (come + go);
        let cell = thing.cell(mapper);
        let rate = cell.map_or(0.0, |cell| mapper.rate(cell));
        let error = |rate: f64| (rate / nominal).ln().abs().min(10f64.ln());
        let holds = |(low, high): (f64, f64)| (low..=high).contains(&nominal);
        let row = Row {
            brier: [0, 1, 2]
                .map(|h| (thing.counts[h] > 0.0).then(|| thing.sums[h].map(|s| s / thing.counts[h]))),
            errors: [error(rate), error(floor.cycle_rate())],
            inside: [cell.is_some_and(|cell| holds(intervals(cell))), holds(floor.interval(0.9))],
            is_found: cell.is_some_and(|cell| mapper.presence(cell, 0.0).is_some()),
        };
        if std::env::var_os("DUMP").is_some() {
            let known: Vec<String> =
                row.brier.iter().flatten().map(|b| format!("{:.3}/{:.3}/{:.3}", b[0], b[1], b[2])).collect();
            println!(
                "  {} cells {} looks {} stays {:.0}/{:.0} s, cycle {:.0} s, found {}: {:.0} s {:?}, floor {:.0} s {:?}, changes {}; {}",
                thing.name,
                thing.cells.len(),
                thing.looks,
                1.0 / come,
                1.0 / go,
                1.0 / nominal,
                row.is_found,
                1.0 / rate,
                cell.map(|cell| {
                    let (l, h) = intervals(cell);
                    ((1.0 / h).round(), (1.0 / l).round())
                }),
                1.0 / floor.cycle_rate(),
                {
                    let (l, h) = floor.interval(0.9);
                    ((1.0 / h).round(), (1.0 / l).round())
                },
                thing.evidence.changes(),
                known.join("  "),
            );
        }
        rows.push(row);
    }
    Ok(rows)
}

fn things_of(spec: &WorldSpec) -> Vec<Thing> {
    let frame = spec.frame;
    let mut things = Vec::new();
    for obstacle in &spec.obstacles {
        let Some(schedule) = obstacle.schedule() else { continue };
        let Changes::Habit(habit) = &schedule.changes else { continue };
        let rates = habit.active.each_ref().map(|stays| 1.0 / stays.mean_s());
        let inside = |index: &usize| {
            let local = obstacle.shape.pose.inverse() * frame.center(frame.cell(*index));
            (local.coords.abs() - obstacle.shape.half_m).max() <= 0.0
        };
        let cells: Vec<usize> = (0..frame.len()).filter(inside).collect();
        let center = Point2::from(obstacle.shape.pose.translation.vector);
        let Some(center) = frame.index(frame.cell_at(&center)) else { continue };
        things.push(Thing {
            name: obstacle.name.clone(),
            cells,
            center,
            rates,
            evidence: Evidence::default(),
            last: None,
            looks: 0,
            open: Default::default(),
            sums: Default::default(),
            counts: Default::default(),
        });
    }
    things
}

impl Thing {
    fn look(&mut self, time_s: f64, is_there: bool) {
        if let Some((last_s, was_there)) = self.last.replace((time_s, is_there)) {
            let length_s = time_s - last_s;
            if length_s <= MAX_GAP_S {
                self.evidence.watch(was_there, length_s);
                if is_there != was_there {
                    self.evidence.change(was_there);
                }
            } else {
                self.looks += 1;
                self.evidence.gap(was_there, is_there, length_s);
            }
        }
    }

    /// The cell by which the map knows the thing.
    fn cell(&self, mapper: &Mapper) -> Option<usize> {
        let mut known: Vec<(f64, usize)> =
            self.cells.iter().filter_map(|cell| Some((mapper.presence(*cell, 0.0)?, *cell))).collect();
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        let changed = || mapper.changed().find(|cell| self.cells.contains(cell));
        known.get(known.len() / 2).map(|(_, cell)| *cell).or_else(changed)
    }

    fn predicted(&self, mapper: &Mapper, ahead_s: f64) -> f64 {
        let by_thing = self.cell(mapper).and_then(|cell| mapper.presence(cell, ahead_s));
        by_thing.unwrap_or_else(|| {
            let known =
                self.cells.iter().filter(|cell| mapper.states().cells()[**cell] != CellState::Unknown);
            known.map(|cell| mapper.blocked_probability_later(*cell, ahead_s)).reduce(f64::max).unwrap_or(0.5)
        })
    }
}

fn report(name: &str, rows: &[Row]) {
    let mut line =
        format!("{name}: {} things, found {}", rows.len(), rows.iter().filter(|row| row.is_found).count());
    for horizon in 0..AHEAD_S.len() {
        let briers: Vec<[f64; 4]> = rows.iter().filter_map(|row| row.brier[horizon]).collect();
        let mean = |who: usize| briers.iter().map(|brier| brier[who]).sum::<f64>() / briers.len() as f64;
        let [ours, nominal, floor, last] = [0, 1, 2, 3].map(mean);
        line += &format!(
            "; {:.0} s: {ours:.4} ÷ nominal {:.3} ÷ floor {:.3} (last {:.3})",
            AHEAD_S[horizon],
            ours / nominal,
            ours / floor,
            last / nominal
        );
    }
    let n = rows.len() as f64;
    for (who, name) in WHO.into_iter().step_by(2).enumerate() {
        let error = rows.iter().map(|row| row.errors[who]).sum::<f64>() / n;
        let inside = rows.iter().filter(|row| row.inside[who]).count() as f64 / n;
        line += &format!("; {name}: log error {error:.3}, inside {inside:.3}");
    }
    println!("{line}");
}

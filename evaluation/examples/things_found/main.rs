//! Which doors a robot finds, and how well it knows them.
//!
//! ```text
//! cargo run -p curious-evaluation --example things_found -- MINUTES [WORLD:]SEED..
//! cargo run -p curious-evaluation --example things_found -- 20 5000 5001 office-7:7 house:1 cave:1
//! ```
//!
//! A curious robot explores each world. Doors that moved at least three times in view must be found: a motion is the moment at
//! which a leaf leaves its closed place or comes to it, in view if the robot sees at least a quarter of the cells that the leaf
//! sweeps. A found door is at most 0.3 m off. Columns, per world:
//!
//! - `must`, `found`: doors that must be found, and those of them that were; `all`, `known`: the same of all doors that moved
//! - `hinged`, `hinge`: hinged doors that were found, and those whose open leaf is known
//! - `false`: doors that are none; `objects`: objects that come and go
//! - `closed_m`, `open_m`: the largest error of an end of the closed leaf, and of the end of the open leaf; the means over doors
//! - `closed_ok`, `open_ok`: the shares of these errors that are at most 0.1 m
//! - `log`, `log_all`, `cells`: the log error of the openings per hour of doors that opened at least three times per hour: of known
//!   doors, and of all; and that of the median rate of the cells that the leaf sweeps
//! - `in_90`: the share of the true openings per hour in the 90 % interval

mod truth;

use agent::Policy;
use evaluation::physics_trial::{self, PhysicsTrial};
use mapper::{Door, Leaf, Mapper};
use nalgebra::{Point2, Vector2};
use sim::physics::WorldSpec;
use std::error::Error;
use std::f64::consts::LN_10;
use truth::TrueDoor;

/// A door is found if the ends of its closed leaf are at most this far off, m.
const FOUND_M: f64 = 0.3;

const COLUMNS: [&str; 16] = [
    "must",
    "found",
    "all",
    "known",
    "hinged",
    "hinge",
    "false",
    "objects",
    "closed_m",
    "open_m",
    "closed_ok",
    "open_ok",
    "log",
    "log_all",
    "cells",
    "in_90",
];
/// The columns that are numbers of things; the others are means.
const COUNTS: usize = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [minutes, worlds @ ..] = &arguments[..] else {
        return Err("usage: things_found MINUTES [WORLD:]SEED..".into());
    };
    let end_s = 60.0 * minutes.parse::<f64>()?;
    print_row("world", &COLUMNS.map(str::to_owned));
    let mut all = Scores::default();
    for world in worlds {
        let (spec, seed) = match world.split_once(':') {
            Some((path, seed)) => (worldfile::shipped::load(path)?, seed.parse()?),
            None => (WorldSpec::generate_house(world.parse()?), world.parse()?),
        };
        let scores = explore(&spec, seed, end_s)?;
        print_row(world, &scores.texts());
        all.add(&scores);
    }
    print_row("all", &all.texts());
    Ok(())
}

/// The numbers of a world: in each column, what was measured of its things.
#[derive(Default)]
struct Scores([Vec<f64>; COLUMNS.len()]);

impl Scores {
    fn put(&mut self, column: &str, value: f64) {
        if let Some(at) = COLUMNS.iter().position(|name| *name == column) {
            self.0[at].push(value);
        }
    }

    fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(all, values)| all.extend(values));
    }

    fn texts(&self) -> [String; COLUMNS.len()] {
        std::array::from_fn(|column| {
            let values = &self.0[column];
            let sum = values.iter().fold(0.0, |sum, value| sum + value);
            match column {
                _ if column < COUNTS => format!("{sum}"),
                _ if values.is_empty() => "–".to_owned(),
                _ => format!("{:.3}", sum / values.len() as f64),
            }
        })
    }
}

fn explore(spec: &WorldSpec, seed: u64, end_s: f64) -> Result<Scores, Box<dyn Error>> {
    let settings = physics_trial::settings(spec)?;
    let pilot = settings.pilot(settings.agent(&Policy::default(), seed)?, seed)?;
    let mut trial = PhysicsTrial::new(spec, seed, &settings, None, pilot)?;
    let mut doors = TrueDoor::all(trial.world.spec(), trial.robot.mapper.frame());
    while trial.turn()?.reading.time_s < end_s {
        for obstacle in trial.world.fleet().obstacles() {
            let is_it = |door: &&mut TrueDoor| door.index == obstacle.index;
            doors
                .iter_mut()
                .filter(is_it)
                .for_each(|door| door.observe(&obstacle.corners, &trial.robot.mapper));
        }
    }
    Ok(scores(&doors, &trial.robot.mapper, end_s / 3600.0))
}

fn scores(doors: &[TrueDoor], mapper: &Mapper, hours: f64) -> Scores {
    let mut scores = Scores::default();
    let mut found: Vec<&Door> = mapper.doors().iter().collect();
    scores.put("objects", mapper.objects().count() as f64);
    for truth in doors.iter().filter(|door| door.motions > 0) {
        let best = found.iter().map(|door| (truth.error_m(&door.closed), *door));
        let best = best.min_by(|(a, _), (b, _)| a.total_cmp(b)).filter(|(error_m, _)| *error_m <= FOUND_M);
        let is_found = f64::from(u8::from(best.is_some()));
        scores.put("all", 1.0);
        scores.put("known", is_found);
        if truth.motions_in_view >= 3 {
            scores.put("must", 1.0);
            scores.put("found", is_found);
        }
        if let Some((error_m, door)) = best {
            scores.put("closed_m", error_m);
            scores.put("closed_ok", is_near(error_m));
            found.retain(|other| !std::ptr::eq(*other, door));
            compare_leaf(truth, door, &mut scores);
        }
        compare_rate(truth, best.map(|(_, door)| door), mapper, hours, &mut scores);
    }
    scores.put("false", found.len() as f64);
    scores
}

/// Whether an error is at most 0.1 m: 1 or 0.
fn is_near(error_m: f64) -> f64 {
    f64::from(u8::from(error_m <= 0.1))
}

/// Compares the open leaf.
fn compare_leaf(truth: &TrueDoor, door: &Door, scores: &mut Scores) {
    let Some(true_end) = truth.open_end else { return };
    scores.put("hinged", 1.0);
    if let Leaf::Hinged { hinge, length_m, open_rad, .. } = door.leaf {
        let end: Point2<f64> = hinge + interfaces::rotation(open_rad) * Vector2::x() * length_m;
        scores.put("hinge", 1.0);
        let error_m = (end - true_end).norm();
        scores.put("open_m", error_m);
        scores.put("open_ok", is_near(error_m));
    }
}

/// Compares the openings per hour.
fn compare_rate(truth: &TrueDoor, door: Option<&Door>, mapper: &Mapper, hours: f64, scores: &mut Scores) {
    let true_rate = f64::from(truth.openings) / hours;
    if true_rate < 3.0 {
        return;
    }
    let error = |rate: Option<f64>| {
        let log = rate.filter(|rate| *rate > 0.0).map_or(LN_10, |rate| libm::log(rate / true_rate).abs());
        log.min(LN_10)
    };
    let mut rates: Vec<f64> = truth.cells.iter().map(|&index| 3600.0 * mapper.rate(index)).collect();
    rates.sort_by(f64::total_cmp);
    scores.put("cells", error(rates.get(rates.len() / 2).copied()));
    let own = error(door.map(|door| door.openings_per_hour().0));
    scores.put("log_all", own);
    if door.is_some() {
        scores.put("log", own);
    }
    if let Some((_, [low, high])) = door.map(Door::openings_per_hour) {
        scores.put("in_90", f64::from(u8::from((low..=high).contains(&true_rate))));
    }
}

fn print_row(name: &str, values: &[String; COLUMNS.len()]) {
    print!("{name:<30}");
    values.iter().for_each(|value| print!(" {value:>9}"));
    println!();
}

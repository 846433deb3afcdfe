//! One mapper update from exact cells, and the features: the mapper's part of a step in a grid world of 25 × 25
//! cells with a sensor range of four cells, in which two blocks have changed 24 cells. Most of the time is spent in
//! `observe_states` in `mapper/src/change/cell_map/observing.rs`.

#[allow(dead_code)] // the bench needs one habit only
#[path = "../../examples/estimators/robots.rs"]
mod robots;

use agent::Features;
use divan::Bencher;
use interfaces::{CellReading, World};
use mapper::{Mapper, MapperSettings};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use robots::{Habit, Robot};
use sim::grid::{GridSpec, GridWorld};

/// The number of steps in a round; the next round repeats them at later times.
const STEPS: usize = 5000;
/// The number of updates that are measured together.
const BATCH: usize = 100;

fn main() {
    divan::main();
}

/// The readings of a robot that follows moving blocks.
fn readings() -> (GridSpec, Vec<CellReading>) {
    let world = include_str!("../../worlds/two_blocks.toml");
    let spec = worldfile::grid::parse("two_blocks.toml", world).unwrap();
    let mut robot = Robot::new(&spec, Habit::Follows, ChaCha8Rng::seed_from_u64(1));
    let mut world = GridWorld::new(&spec, 1);
    let readings = (0..STEPS)
        .map(|_| {
            let reading = world.sense();
            world.act(&robot.act(&reading));
            reading
        })
        .collect();
    (spec, readings)
}

/// The time of [`BATCH`] steps.
#[divan::bench(args = ["paper", "two-state", "two-state-gaps"])]
fn hundred_steps(bencher: Bencher, estimator: &str) {
    let (spec, mut readings) = readings();
    let estimator = estimator.parse().unwrap();
    let settings = MapperSettings { estimator, ..MapperSettings::default() };
    let mut mapper = Mapper::new(&settings, *spec.frame()).unwrap();
    let mut next = 0;
    bencher.bench_local(|| {
        for _ in 0..BATCH {
            mapper.update(&readings[next]).unwrap();
            divan::black_box(Features::of(&mut mapper));
            readings[next].time += STEPS as f64; // for the next round
            next = (next + 1) % STEPS;
        }
    });
}

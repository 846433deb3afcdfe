//! The time of a step of a grid world: `cargo bench -p curious-evaluation --bench grid_world`.

mod generated;

use divan::{Bencher, black_box};
use generated::generated;
use interfaces::{Step, World};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use sim::grid::GridWorld;

/// The number of cells per side, and the range of the sensor.
const SIZES: [(u32, u32); 4] = [(25, 4), (25, 8), (200, 4), (200, 8)];
/// The steps of a walk, repeated.
const STEPS: usize = 4096;

fn main() {
    divan::main();
}

/// A random world of `side` × `side` cells; larger worlds have more walls.
fn world(side: u32, radius: u32) -> GridWorld {
    GridWorld::new(&generated(side, radius, 1), 1)
}

/// A walk that continues in one direction for a while.
fn walk() -> Vec<Step> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut way = Vec::with_capacity(STEPS);
    while way.len() < STEPS {
        let step = Step::ALL[rng.random_range(0..Step::ALL.len())];
        way.extend(std::iter::repeat_n(step, rng.random_range(1..12)));
    }
    way.truncate(STEPS);
    way
}

/// A thousand steps without sensing.
#[divan::bench(args = SIZES)]
fn act_1000(bencher: Bencher<'_, '_>, (side, radius): (u32, u32)) {
    let (mut world, mut way) = (world(side, radius), walk().into_iter().cycle());
    bencher.bench_local(|| {
        for step in way.by_ref().take(1000) {
            world.act(black_box(&step));
        }
    });
}

/// A thousand steps with sensing.
#[divan::bench(args = SIZES)]
fn act_and_sense_1000(bencher: Bencher<'_, '_>, (side, radius): (u32, u32)) {
    let (mut world, mut way) = (world(side, radius), walk().into_iter().cycle());
    bencher.bench_local(|| {
        for step in way.by_ref().take(1000) {
            world.act(black_box(&step));
            black_box(world.sense());
        }
    });
}

/// Making a world: for every cell, the view of a sensor with this range is computed.
#[divan::bench(args = [4, 8, 100])]
fn new(bencher: Bencher<'_, '_>, radius: u32) {
    let spec = world(25, radius).spec().clone();
    bencher.bench_local(|| GridWorld::new(black_box(&spec), 1));
}

//! What a tick costs, in the shipped four rooms with the parts that the program runs with.
//!
//! A tick is 0.1 s of simulated time: 0.1 s over the time of [`tick`] is the real-time factor of
//! the robot alone, without metrics and recording; 200 µs are 500 times real time. 60 s over the
//! time of [`explore_60_s`] is the same with what a start costs, and with metrics or without.
//!
//! `cargo bench --bench tick` measures the release build. `cargo bench --profile dev --bench tick`
//! is built sooner: there, too, our crates and the physics are optimised.

// The program's own way from arguments to parts: the bench must not measure another robot.
#[path = "../src/bin/four_rooms/args.rs"]
#[expect(unused_imports, reason = "its tests run with the program")]
mod args;
#[path = "../src/bin/four_rooms/parts.rs"]
#[expect(dead_code, reason = "a bench is driven by the agent alone")]
mod parts;

use agent::{Agent, Features};
use args::Args;
use clap::Parser;
use controller::DiffDrive;
use evaluation::map_hash::map_hash;
use evaluation::observer::Observer;
use interfaces::World;
use mapper::{Mapper, ReadingError};
use parts::Parts;
use robot::{Autonomous, Belief, Pilot, explore};
use sim::physics::PhysicsWorld;
use std::ops::ControlFlow;

fn main() {
    divan::main();
}

/// A robot in the shipped world.
struct Life {
    world: PhysicsWorld,
    mapper: Mapper,
    pilot: Autonomous<Agent, DiffDrive>,
}

impl Life {
    fn new() -> Self {
        let args = Args::parse_from(["four_rooms"]);
        let make = || Parts::new(&args).and_then(|parts| Ok((parts.settings.agent(&args)?, parts)));
        let Ok((pilot, Parts { world, mapper, .. })) = make() else { panic!("the shipped world is wrong") };
        Self { world, mapper, pilot }
    }

    fn tick(&mut self) {
        let reading = self.world.sense();
        self.mapper.update(&reading).expect("the physics world gives readings that make sense");
        let belief =
            Belief { pose: &reading.pose, features: Features::of(&mut self.mapper), mapper: &self.mapper };
        let command = self.pilot.command(&belief);
        self.pilot.take_messages();
        self.world.act(&command);
    }

    /// Lives until `end_s`, watched or not.
    fn explore(&mut self, end_s: f64, mut observer: Option<Observer>) {
        let Self { world, mapper, pilot } = self;
        explore(world, mapper, pilot, |world, reading, belief, pilot| -> Result<_, ReadingError> {
            match &mut observer {
                Some(observer) => observer.observe(world, reading, belief, pilot),
                None => drop(pilot.take_messages()),
            }
            let is_over = reading.time_s >= end_s;
            Ok(if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        })
        .expect("the physics world gives readings that make sense");
    }
}

/// One tick, on average over 500 simulated seconds, of a robot that has explored for 300.
#[divan::bench(sample_count = 10, sample_size = 500)]
fn tick(bencher: divan::Bencher) {
    let mut life = Life::new();
    life.explore(300.0, None);
    bencher.bench_local(|| life.tick());
}

/// The first 60 simulated seconds; with the metrics, or without.
#[divan::bench(args = [false, true], sample_count = 10, sample_size = 1)]
fn explore_60_s(bencher: divan::Bencher, with_metrics: bool) {
    let prepared = || {
        let life = Life::new();
        let observer = with_metrics.then(|| Observer::default());
        (life, observer)
    };
    bencher.with_inputs(prepared).bench_local_values(|(mut life, observer)| life.explore(60.0, observer));
}

/// The hash over every map and statistic, as at the end of every run.
#[divan::bench(sample_count = 20)]
fn hash_of_the_map(bencher: divan::Bencher) {
    let mut life = Life::new();
    life.explore(60.0, None);
    bencher.bench_local(|| map_hash(&life.mapper));
}

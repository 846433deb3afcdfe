//! The time of a tick in the shipped four rooms, with the parts that the program uses.
//!
//! A tick is 0.1 s of simulated time: 0.1 s divided by the time of [`tick`] is the real-time factor of the robot
//! alone, without metrics and recording; 200 µs are 500 times real time. 60 s divided by the time of
//! [`explore_60_s`] is the real-time factor including the start, with or without metrics.
//!
//! Run it by `cargo bench -p curious-evaluation --bench tick`.

use agent::{Agent, Policy};
use controller::{Controller, DiffDrive};
use evaluation::observer::Observer;
use evaluation::observer::map_hash;
use evaluation::physics_trial::{self, PhysicsTrial};
use interfaces::{LaserReading, World};
use robot::{Autonomous, Pilot, Robot};
use sim::physics::PhysicsWorld;

fn main() {
    divan::main();
}

/// A robot in the shipped world.
struct Run {
    world: PhysicsWorld,
    robot: Robot<LaserReading, Autonomous<Agent, Controller<DiffDrive>>>,
}

impl Run {
    fn new(world: &str) -> Self {
        let spec = worldfile::shipped::load(world).expect("the shipped world is valid");
        let settings = physics_trial::settings(&spec).expect("the robot has a differential drive");
        let agent = settings.agent(&Policy::default(), 0).expect("the default settings are valid");
        let pilot = settings.pilot(agent, 0).expect("the default settings are valid");
        let trial = PhysicsTrial::new(&spec, 0, &settings, None, pilot);
        let PhysicsTrial { world, robot, .. } = trial.expect("the default settings are valid");
        Self { world, robot }
    }

    fn tick(&mut self) {
        let turn = self.robot.step(self.world.sense());
        let turn = turn.expect("the physics world gives readings that are valid");
        self.robot.pilot.take_messages();
        self.world.act(&turn.command);
    }

    /// Runs until `end_s`, with the metrics or without.
    fn explore(&mut self, end_s: f64, mut observer: Option<Observer>) {
        let (mut command, mut time_s) = (None, 0.0);
        while time_s < end_s {
            let turn = robot::turn(&mut self.world, &mut self.robot, &mut command);
            let turn = turn.expect("the physics world gives readings that are valid");
            match &mut observer {
                Some(observer) => observer.observe(&self.world, &mut self.robot, &turn),
                None => drop(self.robot.pilot.take_messages()),
            }
            time_s = turn.reading.time_s;
        }
    }
}

/// One tick, averaged over 500 simulated seconds, of a robot that has explored for 300 s.
#[divan::bench(sample_count = 10, sample_size = 500)]
fn tick(bencher: divan::Bencher) {
    let mut run = Run::new("four_rooms");
    run.explore(300.0, None);
    bencher.bench_local(|| run.tick());
}

/// The first 60 simulated seconds; with the metrics, or without.
#[divan::bench(args = [false, true], sample_count = 10, sample_size = 1)]
fn explore_60_s(bencher: divan::Bencher, with_metrics: bool) {
    let prepared = || {
        let run = Run::new("four_rooms");
        let observer = with_metrics.then(Observer::default);
        (run, observer)
    };
    bencher.with_inputs(prepared).bench_local_values(|(mut run, observer)| run.explore(60.0, observer));
}

/// The first 60 simulated seconds of the worlds in which much moves, with the metrics.
#[divan::bench(args = ["house", "office", "cave", "warehouse", "yard"], sample_count = 5, sample_size = 1)]
fn explore_60_s_of(bencher: divan::Bencher, world: &str) {
    let prepared = || (Run::new(world), Observer::default());
    bencher.with_inputs(prepared).bench_local_values(|(mut run, observer)| run.explore(60.0, Some(observer)));
}

/// The hash of every map and statistic, as at the end of every run.
#[divan::bench(sample_count = 20)]
fn hash_of_the_map(bencher: divan::Bencher) {
    let mut run = Run::new("four_rooms");
    run.explore(60.0, None);
    bencher.bench_local(|| map_hash(&run.robot.mapper));
}

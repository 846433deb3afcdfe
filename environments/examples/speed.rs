//! How fast fleets and the driving task are in Rust alone, per second of CPU time: what `python/examples/speed.py --rust` compares with.
//!
//! ```sh
//! cargo build --release -p curious-environments --example speed
//! target/release/examples/speed fleet WORLD.toml SECONDS
//! target/release/examples/speed drive WORLDS THREADS STEPS
//! ```
//!
//! It prints one line: robot steps of 0.1 s (or steps of the task) per second of CPU time, and per second.

use environments::{Batch, Drive, DrivePlace, DriveSettings};
use interfaces::Twist;
use sim::physics::Fleet;
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |index: usize| -> Result<usize, Box<dyn Error>> {
        Ok(args.get(index).ok_or("an argument is missing")?.parse()?)
    };
    match args.first().map(String::as_str) {
        Some("fleet") => fleet(args.get(1).ok_or("the world is missing")?, number(2)?),
        Some("drive") => {
            let place = Arc::new(DrivePlace::new(&environments::driving_hall(), DriveSettings::default())?);
            steps((0..number(1)?).map(|_| Drive::new(&place)).collect(), number(2)?, number(3)?)
        }
        _ => Err("the first argument is fleet or drive".into()),
    }
}

/// Every driven robot drives and measures every 0.1 s.
fn fleet(path: &str, seconds: usize) -> Result<(), Box<dyn Error>> {
    let spec = worldfile::physics::parse_fleet(path, &std::fs::read_to_string(path)?)?;
    let driven: Vec<usize> = spec.driven_robots().collect();
    let mut fleet = Fleet::new(&spec, 1);
    let (mut ranges_m, mut poses) = (vec![0.0; fleet.beams()], vec![[0.0; 3]; spec.robots.len()]);
    let (begin, mut calls) = (Clock::now()?, 0);
    while begin.cpu_s()? < seconds as f64 {
        // The clock is read rarely.
        for _ in 0..100 {
            for &robot in &driven {
                fleet.command(robot, Twist { linear_mps: 0.4, angular_radps: 0.3 });
            }
            fleet.run_until(fleet.time_s() + 0.1, &mut ());
            fleet.look_all();
            fleet.copy_scans(&mut ranges_m)?;
            fleet.copy_poses(&mut poses)?;
        }
        calls += 100;
    }
    begin.print(calls * driven.len())
}

/// Steps with random actions, forward, with resets.
fn steps(tasks: Vec<Drive>, threads: usize, steps: usize) -> Result<(), Box<dyn Error>> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    let (count, mut state) = (tasks.len(), 1_u64);
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    let mut actions = || (0..count).flat_map(|_| [uniform().abs(), uniform()]).collect();
    let actions: Vec<Vec<f32>> = (0..100).map(|_| actions()).collect();
    let mut batch = Batch::new(tasks);
    batch.is_parallel = threads > 1;
    let seeds = |step: usize| (0..count).map(|index| (step * count + index) as u64).collect::<Vec<u64>>();
    batch.reset(&seeds(0))?;
    let begin = Clock::now()?;
    for step in 1..=steps {
        batch.step(&actions[step % 100], &seeds(step))?;
    }
    begin.print(count * steps)
}

/// Two clocks: of this process, and of the wall.
struct Clock(f64, Instant);

impl Clock {
    fn now() -> Result<Self, Box<dyn Error>> {
        Ok(Self(process_s()?, Instant::now()))
    }

    fn cpu_s(&self) -> Result<f64, Box<dyn Error>> {
        Ok(process_s()? - self.0)
    }

    fn print(&self, steps: usize) -> Result<(), Box<dyn Error>> {
        let (cpu_s, wall_s) = (self.cpu_s()?, self.1.elapsed().as_secs_f64());
        println!("{:.0} per CPU second, {:.0} per second", steps as f64 / cpu_s, steps as f64 / wall_s);
        Ok(())
    }
}

/// The CPU time of this process, s: user and system time in hundredths of a second, the 14th and 15th value of Linux.
fn process_s() -> Result<f64, Box<dyn Error>> {
    let stat = std::fs::read_to_string("/proc/self/stat")?;
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let mut values = after_name.split_whitespace().skip(11);
    let mut next = || -> Result<f64, Box<dyn Error>> { Ok(values.next().ok_or("no CPU time")?.parse()?) };
    Ok((next()? + next()?) / 100.0)
}

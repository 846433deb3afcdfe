//! How well a robot with bad odometry finds its place, and how many false changes its map gains.
//!
//! A robot drives to random goals in a world. Two maps learn from the same scans: one with the true poses, one with the
//! estimated poses. Printed: the error of the pose, the time without a certain pose, the false changes of both maps
//! (changes of cells that nothing ever touched), and the time per scan; after jumps of the odometry (`jump_m`, `jump_deg`)
//! and a robot that is carried (`carried_m`, `carried_deg`), the time until the pose is found; in runs of hours, where the
//! estimates put fixed corners.
//!
//! ```text
//! cargo run -p curious-evaluation --example drift -- generate=1000 seed=1000 minutes=20 beams=360 noise=0.01
//! cargo run -p curious-evaluation --example drift -- world=worlds/house.toml closed=1
//! cargo run -p curious-evaluation --example drift -- carried_m=3 carried_deg=180
//! cargo run -p curious-evaluation --example drift -- shelves=1
//! cargo run -p curious-evaluation --example drift -- trials=4 minutes=4 row=1 table=houses variant="360 beams"
//! ```

mod corners;
mod driver;
mod options;
mod recovery;
mod relocations;
mod row;
mod score;
mod shelves;

use corners::Corners;
use driver::Driver;
use interfaces::{LaserReading, World};
use localizer::{GivenPoses, Localizer, LoopClosed, LoopClosingLocalizer, PoseState};
use mapper::Mapper;
use options::Options;
use robot::Permission;
use score::Score;
use sim::physics::PhysicsWorld;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options = Options::parse(std::env::args().skip(1))?;
    let mut total = Score::default();
    for seed in options.seeds() {
        let score = run(&options, seed)?;
        score.print(&format!("{} seed {seed}", options.name()));
        total.add(&score);
    }
    if options.trials > 1 {
        total.print("all");
    }
    if options.row { row::print(&row::Row::of(&options, &total)) } else { Ok(()) }
}

/// One run.
fn run(options: &Options, seed: u64) -> Result<Score, Box<dyn std::error::Error>> {
    let spec = options.spec(seed)?;
    let mut world = PhysicsWorld::new(&spec, seed);
    let settings = evaluation::physics_trial::settings(&spec)?;
    let mut true_poses = GivenPoses::default();
    let mut exact = Mapper::new(&settings.mapper, spec.frame)?;
    let mut estimated = Mapper::new(&settings.mapper, spec.frame)?;
    let start = *world.true_pose();
    let mut localizer = LoopClosingLocalizer::from_nothing(&settings.localizer, &spec.frame, start)?;
    let mut alone = Localizer::from_nothing(&settings.localizer, &spec.frame, start)?;
    let mut driver = Driver::new(&settings, seed)?;
    let mut score = Score::new(&spec.frame);
    let mut corners = Corners::new(&spec.frame);
    let first_odometry = world.sense().pose;
    while world.time_s() < options.minutes * 60.0 {
        let reading = world.sense();
        let true_pose = *world.true_pose();
        exact.update(&true_poses.deskewed(LaserReading { pose: true_pose, ..reading.clone() }))?;
        let odometry = reading.pose;
        let begin = Instant::now();
        let without_loops = |localized| LoopClosed { localized, correction: None };
        let LoopClosed { localized, correction } = if options.odometry_only {
            without_loops(score::by_odometry(start * first_odometry.inv_mul(&reading.pose), reading))
        } else if options.no_loops {
            without_loops(alone.localize(&reading, &estimated))
        } else {
            localizer.localize(&reading, &mut estimated)
        };
        let elapsed = begin.elapsed();
        if let Some(correction) = correction {
            println!("    at {:.1} s: {correction}; {:.0} ms", world.time_s(), elapsed.as_secs_f64() * 1e3);
            score.learned_again(&estimated);
        }
        let estimate = &localized.estimate;
        let enters_map = estimate.state == PoseState::Tracking;
        match enters_map {
            true => estimated.update(&localized.reading)?,
            false => estimated.skip(&localized.reading),
        }
        score.observe(estimate, &true_pose, &exact, enters_map.then_some(&estimated), elapsed);
        corners.observe(world.time_s(), estimate, &true_pose);
        score.recovery.observe(world.time_s(), estimate, &true_pose, &odometry);
        let permission = match estimate.state {
            _ if world.time_s() < 2.0 || options.rests_at(world.time_s()) => Permission::Rest,
            PoseState::Lost if options.closed => Permission::LookAround,
            _ => Permission::Drive,
        };
        let command = if options.closed {
            driver.command(&estimated, &estimate.pose, permission)
        } else {
            driver.command(&exact, &true_pose, permission)
        };
        world.act(&command);
    }
    score.finish(world.truth());
    if options.relocate {
        relocations::run(options, &settings.localizer, &spec, seed)?;
    }
    Ok(score)
}

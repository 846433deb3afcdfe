//! An estimator of your own, in the physics world of four_rooms and in grid trials.
//!
//! ```text
//! cargo run --example own_estimator
//! ```

use agent::Policy;
use evaluation::physics_trial::{self, PhysicsTrial};
use evaluation::trials::{Experiment, GridRobot, TrialStrategy};
use mapper::{CellStatistics, Estimator, EstimatorChoice};
use reports::Report;

/// Half of all events, divided by the time in view: a cycle has one block event and one free event.
#[derive(Debug)]
struct HalfOfEvents;

impl Estimator for HalfOfEvents {
    fn name(&self) -> &'static str {
        "half-of-events"
    }

    fn interval(&self, seen: &CellStatistics) -> f64 {
        2.0 * seen.observed() / f64::from(seen.block_events + seen.free_events)
    }
}

fn main() -> anyhow::Result<()> {
    let world = curious::worlds::load("four_rooms")?.spec;
    let mut settings = physics_trial::settings(&world)?;
    settings.mapper.estimator = HalfOfEvents.into();
    let pilot = settings.pilot(settings.agent(&Policy::default(), 0)?, 0)?;
    let mut trial = PhysicsTrial::new(&world, 0, &settings, None, pilot)?;
    trial.run(300.0)?;
    println!("four rooms, 5 minutes\n{}\n", trial.results());

    let experiment = Experiment {
        worlds: vec![curious::worlds::load_grid("two_blocks")?],
        estimators: vec![HalfOfEvents.into(), EstimatorChoice::default()],
        strategies: vec![TrialStrategy::Agent(Policy::default())],
        trials: 3,
        seed: 0,
        length: 5_000,
        robot: GridRobot::default(),
    };
    println!("{}", Report::of(&experiment)?.table());
    Ok(())
}

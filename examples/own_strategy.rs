//! A strategy of your own, in the physics world of four_rooms, in grid trials, and in trials in generated houses.
//!
//! ```text
//! cargo run --example own_strategy
//! ```

use agent::{Policy, Situation, Strategy};
use evaluation::physics_trial::{self, PhysicsTrial};
use evaluation::trials::{Experiment, GridRobot, PhysicsRobot, TrialStrategy};
use mapper::MapperSettings;
use reports::Report;
use sim::physics::WorldSpec;

/// Goes to old cells, and prefers cells that changed before.
#[derive(Debug)]
struct Events;

impl Strategy for Events {
    fn name(&self) -> &'static str {
        "events"
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        for (index, weight) in weights.iter_mut().enumerate() {
            let events = situation.mapper.statistics(index).events();
            *weight = situation.mapper.recency(index) * (1.0 + f64::from(events));
        }
    }
}

fn main() -> anyhow::Result<()> {
    let events = Policy::single("events", "old cells that changed before", |_| Events);

    let world = curious::worlds::load("four_rooms")?.spec;
    let settings = physics_trial::settings(&world)?;
    let pilot = settings.pilot(settings.agent(&events, 0)?, 0)?;
    let mut trial = PhysicsTrial::new(&world, 0, &settings, None, pilot)?;
    trial.run(300.0)?;
    println!("four rooms, 5 minutes\n{}\n", trial.results());

    let strategies = [events, Policy::default()].map(TrialStrategy::Agent).to_vec();
    let grid = Experiment {
        worlds: vec![curious::worlds::load_grid("two_blocks")?],
        estimators: vec![MapperSettings::default().estimator],
        strategies: strategies.clone(),
        trials: 3,
        seed: 0,
        length: 5_000,
        robot: GridRobot::default(),
    };
    println!("{}", Report::of(&grid)?.table());

    // More houses and longer trials tell more: 20 minutes in 100 houses take about an hour on two cores.
    let houses = Experiment {
        worlds: (0..4).map(WorldSpec::generate_house).collect(),
        estimators: vec![settings.mapper.estimator], // as house_trials
        strategies,
        trials: 1,
        seed: 0,
        length: 300, // s
        robot: PhysicsRobot::default(),
    };
    println!("{}", Report::of(&houses)?.table());
    Ok(())
}

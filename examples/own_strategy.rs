//! A strategy of your own, in the physics world of four_rooms and in grid trials.
//!
//! ```text
//! cargo run --example own_strategy
//! ```

use agent::{Policy, Situation, Strategy};
use evaluation::physics_trial::{self, PhysicsTrial};
use evaluation::trials::{Experiment, GridRobot, TrialStrategy};
use mapper::MapperSettings;
use reports::Report;

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

    let experiment = Experiment {
        worlds: vec![curious::worlds::load_grid("two_blocks")?],
        estimators: vec![MapperSettings::default().estimator],
        strategies: [events, Policy::default()].map(TrialStrategy::Agent).to_vec(),
        trials: 3,
        seed: 0,
        length: 5_000,
        robot: GridRobot::default(),
    };
    println!("{}", Report::of(&experiment)?.table());
    Ok(())
}

//! A strategy of your own, compared with built-in ones in trials of a grid world.
//!
//! ```text
//! cargo run --example own_strategy
//! ```

use agent::{AgentSettings, Policy, Situation, Strategy};
use controller::CellDrive;
use curious::worlds::load_grid;
use evaluation::trials::{Experiment, TrialStrategy};
use mapper::MapperSettings;
use std::sync::atomic::AtomicBool;

/// Cells that were not seen for long, and are near: the time since the last observation per travel time.
#[derive(Debug)]
struct OldAndNear;

impl Strategy for OldAndNear {
    fn name(&self) -> &'static str {
        "old-and-near"
    }

    fn needs_travel(&self) -> bool {
        true
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        for (index, weight) in weights.iter_mut().enumerate() {
            *weight = situation.mapper.recency(index) / (1.0 + situation.travel[index]);
        }
    }
}

fn main() -> anyhow::Result<()> {
    let own = Policy::single("old-and-near", "what was not seen for long, and is near", |_| OldAndNear);
    let experiment = Experiment {
        worlds: vec![load_grid("two_blocks")?],
        estimators: vec![MapperSettings::default().estimator],
        strategies: [own, "recency".parse()?, "curious".parse()?].map(TrialStrategy::Agent).into(),
        trials: 3,
        seed: 0,
        steps: 5000,
        mapper: MapperSettings::default(),
        agent: AgentSettings::default(),
        controller: CellDrive::settings(),
    };
    for trial in experiment.run(experiment.jobs(), &AtomicBool::new(false), |_| ())? {
        let end = trial.samples.last().expect("a trial has a sample at its end");
        println!("{:15} seed {}: log error {:.2}", trial.strategy, trial.seed, end.log_error);
    }
    Ok(())
}

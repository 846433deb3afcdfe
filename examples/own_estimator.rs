//! An estimator of your own, compared with built-in ones in trials of a grid world.
//!
//! ```text
//! cargo run --example own_estimator
//! ```

use agent::AgentSettings;
use controller::CellDrive;
use curious::worlds::load_grid;
use evaluation::trials::{Experiment, TrialStrategy};
use mapper::{CellStatistics, Estimator, MapperSettings, Paper, TwoStateGaps};
use std::sync::atomic::AtomicBool;

/// All changes over all the time since the first observation, in view or not. Two changes are a cycle.
#[derive(Debug)]
struct AllTime;

impl Estimator for AllTime {
    fn name(&self) -> &'static str {
        "all-time"
    }

    fn interval(&self, seen: &CellStatistics) -> f64 {
        2.0 * (seen.last_seen - seen.first_seen) / f64::from(seen.events())
    }
}

fn main() -> anyhow::Result<()> {
    let experiment = Experiment {
        worlds: vec![load_grid("two_blocks")?],
        estimators: vec![AllTime.into(), Paper.into(), TwoStateGaps.into()],
        strategies: vec![TrialStrategy::Agent("recency".parse()?)],
        trials: 3,
        seed: 0,
        steps: 5000,
        mapper: MapperSettings::default(),
        agent: AgentSettings::default(),
        controller: CellDrive::settings(),
    };
    for trial in experiment.run(experiment.jobs(), &AtomicBool::new(false), |_| ())? {
        let end = trial.samples.last().expect("a trial has a sample at its end");
        println!("{:15} seed {}: log error {:.2}", trial.estimator, trial.seed, end.log_error);
    }
    Ok(())
}

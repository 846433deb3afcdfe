//! Arguments → trials → report.

mod args;

use anyhow::Context;
use args::Args;
use curious::program::{Failure, interrupt_flag, list_physics_worlds, start};
use curious::terminal::say;
use curious::trials::{distinct, run};
use curious::{trials, worlds};
use evaluation::physics_trial::PhysicsSettings;
use evaluation::trials::{Experiment, PhysicsRobot};
use sim::physics::WorldSpec;
use std::io::stderr;
use std::process::ExitCode;

/// The number of generated houses without `--world` and `--generate`.
const HOUSES: u64 = 8;

fn main() -> ExitCode {
    start(|args: &Args| {
        if args.list_worlds {
            list_physics_worlds()?;
            return Ok(ExitCode::SUCCESS);
        }
        let experiment = experiment(args).map_err(Failure::Input)?;
        let is_canceled = interrupt_flag()?; // before any file is made
        let to_toml = |world: &WorldSpec| worldfile::physics::to_toml(world.fleet());
        Ok(run(&args.shared, &args.out, &args.world, &experiment, &is_canceled, to_toml)?)
    })
}

/// The experiment that the arguments describe.
fn experiment(args: &Args) -> anyhow::Result<Experiment<WorldSpec>> {
    Ok(Experiment {
        worlds: worlds(args)?,
        estimators: distinct(args.estimator.clone()),
        strategies: distinct(args.strategy.clone()),
        trials: args.trials,
        seed: args.shared.seed,
        length: args.duration,
        robot: PhysicsRobot { reward: args.shared.reward.into(), max_steps: args.max_steps },
    })
}

/// The named worlds, then the generated houses.
fn worlds(args: &Args) -> anyhow::Result<Vec<WorldSpec>> {
    let mut shared = args.shared.clone();
    if args.world.is_empty() {
        shared.generate.get_or_insert(HOUSES);
    }
    let load = |name: &str| -> anyhow::Result<WorldSpec> {
        let loaded = worlds::load(name)?;
        PhysicsSettings::of(&loaded.spec).with_context(|| format!("cannot run `{name}`"))?;
        for warning in loaded.warnings.iter().filter(|_| !shared.quiet) {
            say(stderr(), format_args!("{warning}\n"));
        }
        Ok(loaded.spec)
    };
    trials::worlds(&shared, &args.world, None, load, WorldSpec::generate_house)
}

//! Arguments → trials → report.

mod args;

use anyhow::Context;
use args::Args;
use curious::program::start;
use curious::shards;
use curious::terminal::say;
use curious::trials::{self, TrialArgs, TrialProgram, distinct};
use curious::worlds;
use evaluation::physics_trial;
use evaluation::trials::{Experiment, PhysicsRobot};
use sim::physics::WorldSpec;
use std::io::stderr;
use std::path::Path;
use std::process::ExitCode;

/// The number of generated houses without `--world` and `--generate`.
const HOUSES: u64 = 8;

fn main() -> ExitCode {
    start(|args: &Args| {
        if args.list_worlds {
            worlds::list_physics_worlds()?;
            return Ok(ExitCode::SUCCESS);
        }
        shards::main(args, args.command.as_ref())
    })
}

impl TrialProgram for Args {
    type Spec = WorldSpec;

    fn shared(&self) -> &TrialArgs {
        &self.shared
    }

    fn out(&self) -> &Path {
        &self.out
    }

    fn world_names(&self) -> &[String] {
        &self.world
    }

    fn experiment(&self) -> anyhow::Result<Experiment<WorldSpec>> {
        Ok(Experiment {
            worlds: worlds(self)?,
            estimators: distinct(self.estimator.clone()),
            strategies: distinct(self.strategy.clone()),
            trials: self.trials,
            seed: self.shared.seed,
            length: self.duration,
            robot: PhysicsRobot {
                reward: self.shared.reward.into(),
                max_steps: self.max_steps,
                pose: self.pose,
            },
        })
    }

    fn to_toml(world: &WorldSpec) -> Option<String> {
        worldfile::physics::to_toml(world.fleet())
    }
}

/// The named worlds, then the generated houses.
fn worlds(args: &Args) -> anyhow::Result<Vec<WorldSpec>> {
    let mut shared = args.shared.clone();
    if args.world.is_empty() {
        shared.generate.get_or_insert(HOUSES);
    }
    let load = |name: &str| -> anyhow::Result<WorldSpec> {
        let loaded = worlds::load(name)?;
        physics_trial::source(&loaded.spec).with_context(|| format!("cannot run `{name}`"))?;
        for warning in loaded.warnings.iter().filter(|_| !shared.quiet) {
            say(stderr(), format_args!("{warning}\n"));
        }
        Ok(loaded.spec)
    };
    trials::worlds(&shared, &args.world, None, load, WorldSpec::generate_house)
}

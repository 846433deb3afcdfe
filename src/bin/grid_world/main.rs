//! Arguments → trials → report.

mod args;

use args::Args;
use controller::CellDrive;
use curious::program::{list, start};
use curious::shards;
use curious::terminal::say;
use curious::trials::{self, TrialArgs, TrialProgram, distinct};
use curious::worlds;
use evaluation::trials::{Experiment, GridRobot};
use mapper::{EstimatorChoice, MapperSettings, Paper};
use sim::grid::{GenerateSettings, GridSpec};
use std::io::stderr;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    start(|args: &Args| {
        if args.list_worlds {
            list(&worlds::SHIPPED_GRID, 20, |name| worlds::load_grid(name).map(|spec| spec.description))?;
            return Ok(ExitCode::SUCCESS);
        }
        shards::main(args, args.command.as_ref())
    })
}

impl TrialProgram for Args {
    type Spec = GridSpec;

    fn shared(&self) -> &TrialArgs {
        &self.shared
    }

    fn out(&self) -> &Path {
        &self.out
    }

    fn world_names(&self) -> &[String] {
        &self.world
    }

    fn experiment(&self) -> anyhow::Result<Experiment<GridSpec>> {
        let mut estimators = self.estimator.clone();
        if estimators.is_empty() {
            estimators = vec![Paper.into(), EstimatorChoice::default()];
        }
        let mut controller = CellDrive::settings();
        controller.exploration.max_steps = self.max_steps;
        let agent = agent::AgentSettings { reward: self.shared.reward.into(), ..Default::default() };
        Ok(Experiment {
            worlds: worlds(self)?,
            estimators: distinct(estimators),
            strategies: distinct(self.strategy.clone()),
            trials: self.trials,
            seed: self.shared.seed,
            length: self.steps,
            robot: GridRobot { mapper: MapperSettings::default(), agent, controller },
        })
    }

    fn to_toml(world: &GridSpec) -> Option<String> {
        Some(worldfile::grid::to_toml(world))
    }
}

/// The named worlds, then the generated worlds, with the changes that the arguments ask for.
fn worlds(args: &Args) -> anyhow::Result<Vec<GridSpec>> {
    let settings = GenerateSettings::default();
    let generate = |seed| GridSpec::generate(&settings, seed);
    let default = Some(worlds::SHIPPED_GRID[0].0);
    let mut worlds = trials::worlds(&args.shared, &args.world, default, worlds::load_grid, generate)?;
    for world in &mut worlds {
        for warning in world.warnings().iter().filter(|_| !args.shared.quiet) {
            say(stderr(), format_args!("warning: {}: {warning}", world.name));
        }
        let mut changed = world.clone();
        if let Some(radius) = args.sensor_radius {
            changed = changed.with_sensor_radius(radius);
        }
        if let Some(probability) = args.stochastic {
            changed = changed.with_probabilities(probability, probability);
        }
        *world = changed;
    }
    Ok(worlds)
}

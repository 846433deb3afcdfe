//! Arguments → trials → report.

mod args;

use args::Args;
use controller::CellDrive;
use curious::program::{Failure, interrupt_flag, list, start};
use curious::terminal::say;
use curious::trials::{distinct, run};
use curious::{trials, worlds};
use evaluation::trials::{Experiment, GridRobot};
use mapper::{EstimatorChoice, MapperSettings, Paper};
use sim::grid::{GenerateSettings, GridSpec};
use std::io::stderr;
use std::process::ExitCode;

fn main() -> ExitCode {
    start(|args: &Args| {
        if args.list_worlds {
            list(&worlds::SHIPPED_GRID, 20, |name| worlds::load_grid(name).map(|spec| spec.description))?;
            return Ok(ExitCode::SUCCESS);
        }
        let experiment = experiment(args).map_err(Failure::Input)?;
        let is_canceled = interrupt_flag()?; // before any file is made
        let to_toml = |world: &GridSpec| Some(worldfile::grid::to_toml(world));
        Ok(run(&args.shared, &args.out, &args.world, &experiment, &is_canceled, to_toml)?)
    })
}

/// The experiment that the arguments describe.
fn experiment(args: &Args) -> anyhow::Result<Experiment<GridSpec>> {
    let mut estimators = args.estimator.clone();
    if estimators.is_empty() {
        estimators = vec![Paper.into(), EstimatorChoice::default()];
    }
    let mut controller = CellDrive::settings();
    controller.exploration.max_steps = args.max_steps;
    let agent = agent::AgentSettings { reward: args.shared.reward.into(), ..Default::default() };
    Ok(Experiment {
        worlds: worlds(args)?,
        estimators: distinct(estimators),
        strategies: distinct(args.strategy.clone()),
        trials: args.trials,
        seed: args.shared.seed,
        length: args.steps,
        robot: GridRobot { mapper: MapperSettings::default(), agent, controller },
    })
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

//! Arguments → trials → report.

mod args;
mod progress;

use anyhow::Context;
use args::Args;
use clap::Parser;
use controller::CellDrive;
use curious::output::{make_folder, write_file};
use curious::report::{Report, ReportSettings, WorldPicture};
use curious::trials::Experiment;
use curious::worlds;
use mapper::{Estimator, MapperSettings};
use progress::Progress;
use sim::grid::{GenerateSettings, GridSpec};
use std::fmt::Display;
use std::io::{Write, stderr, stdout};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

fn main() -> ExitCode {
    let args = Args::parse();
    if args.list_worlds {
        for (name, _) in worlds::SHIPPED_GRID {
            match worlds::load_grid(name) {
                Ok(spec) => say(stdout(), format_args!("{name:<18} {}", spec.description())),
                Err(error) => say(stderr(), error),
            }
        }
        return ExitCode::SUCCESS;
    }
    let experiment = match experiment(&args) {
        Ok(experiment) => experiment,
        Err(error) => {
            say(stderr(), format_args!("error: {error:#}"));
            return ExitCode::from(2);
        }
    };
    match run(&args, &experiment) {
        Ok(code) => code,
        Err(error) => {
            say(stderr(), format_args!("error: {error:#}"));
            ExitCode::FAILURE
        }
    }
}

/// Says `what` to whoever listens. When nobody does any more, as behind `| head`, the run goes on.
fn say(mut to: impl Write, what: impl Display) {
    let _ = writeln!(to, "{what}");
}

/// What the arguments ask for.
fn experiment(args: &Args) -> anyhow::Result<Experiment> {
    let mut estimators = args.estimator.clone();
    if estimators.is_empty() {
        estimators = vec![Estimator::Paper, Estimator::default()];
    }
    let mut controller = CellDrive::settings();
    controller.exploration.max_steps = args.max_steps;
    Ok(Experiment {
        worlds: worlds(args)?,
        estimators: distinct(estimators),
        strategies: distinct(args.strategy.clone()),
        trials: args.trials,
        seed: args.seed,
        steps: args.steps,
        mapper: MapperSettings::default(),
        agent: agent::AgentSettings { reward: args.reward.into(), ..Default::default() },
        controller,
    })
}

/// The worlds that were named, then those that are made; with what the arguments change in all.
fn worlds(args: &Args) -> anyhow::Result<Vec<GridSpec>> {
    let mut names: Vec<&str> = args.world.iter().map(String::as_str).collect();
    if names.is_empty() && args.generate.is_none() {
        names.push(worlds::SHIPPED_GRID[0].0);
    }
    let mut worlds = distinct(names).into_iter().map(worlds::load_grid).collect::<Result<Vec<_>, _>>()?;
    let settings = GenerateSettings::default();
    let made = 0..args.generate.unwrap_or(0);
    worlds.extend(made.map(|number| GridSpec::generate(&settings, args.seed.wrapping_add(number))));
    for world in &mut worlds {
        for warning in world.warnings() {
            say(stderr(), format_args!("warning: {warning}"));
        }
        let mut changed = world.clone();
        if let Some(radius) = args.sensor_radius {
            changed = changed.with_sensor_radius(radius);
        }
        if let Some(chance) = args.stochastic {
            changed = changed.with_chances(chance, chance);
        }
        *world = changed;
    }
    Ok(worlds)
}

/// Each value once, where it first comes.
fn distinct<T: PartialEq>(values: Vec<T>) -> Vec<T> {
    let mut distinct = Vec::new();
    for value in values {
        if !distinct.contains(&value) {
            distinct.push(value);
        }
    }
    distinct
}

/// Runs the trials, and writes what came of them.
fn run(args: &Args, experiment: &Experiment) -> anyhow::Result<ExitCode> {
    make_folder(&args.out)?;
    let is_cancelled = Arc::new(AtomicBool::new(false));
    let flag = is_cancelled.clone();
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).context("cannot listen for Ctrl-C")?;
    let threads = usize::from(args.threads.unwrap_or(0)); // 0: as many as there are cores
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().context("cannot make threads")?;

    let progress = Progress::new(experiment.jobs().len(), args.quiet);
    let trials = pool.install(|| experiment.run(&is_cancelled, |_| progress.step()));
    progress.finish();
    let (trials, is_interrupted) = (trials?, is_cancelled.load(Ordering::Relaxed));
    if trials.is_empty() {
        say(stderr(), "interrupted before the first trial was finished: there is nothing to report");
        return Ok(ExitCode::from(130));
    }
    if args.save_worlds {
        for world in &experiment.worlds {
            let path = args.out.join(format!("{}.toml", world.name()));
            write_file(&path, |file| file.write_all(world.to_toml().as_bytes()))?;
        }
    }
    let settings = ReportSettings {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        arguments: std::env::args().skip(1).collect(),
        steps: args.steps,
        trials: args.trials,
        sensor_radius: experiment.worlds[0].sensor_radius(),
        interrupted: is_interrupted,
        worlds: experiment.worlds.iter().map(|world| world.name().to_owned()).collect(),
        estimators: experiment.estimators.iter().map(|estimator| estimator.name().to_owned()).collect(),
        strategies: experiment.strategies.iter().map(|strategy| strategy.name().to_owned()).collect(),
    };
    let pictures: Vec<_> = experiment.worlds.iter().map(picture).collect();
    let report = Report::new(settings, trials);
    let files = report.write(&args.out, &pictures)?;
    if !args.quiet {
        say(stdout(), report.table());
        let names: Vec<_> = files.iter().filter_map(|file| file.file_name()?.to_str()).collect();
        say(stdout(), format_args!("written to {}: {}", args.out.display(), names.join(", ")));
    }
    Ok(if is_interrupted { ExitCode::from(130) } else { ExitCode::SUCCESS })
}

/// What a world looks like.
fn picture(world: &GridSpec) -> WorldPicture {
    let (frame, at) = (world.frame(), |cell: &geometry::Cell| (cell.x as usize, cell.y as usize));
    let block = |block: &sim::grid::BlockSpec| (block.name.clone(), block.path.iter().map(at).collect());
    WorldPicture {
        name: world.name().to_owned(),
        walls: world.walls().cells().chunks(frame.width()).map(<[bool]>::to_vec).collect(),
        things: world.blocks().iter().map(block).collect(),
        start: at(&world.start()),
        sensor_radius: world.sensor_radius(),
    }
}

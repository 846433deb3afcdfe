//! Arguments → trials → report.

mod args;

use anyhow::{Context, bail};
use args::Args;
use controller::CellDrive;
use curious::program::{Failure, INTERRUPTED, interrupt_flag, list, start};
use curious::progress::Progress;
use curious::terminal::{print, say};
use curious::worlds;
use evaluation::output::{RunFolder, write_file};
use evaluation::report::{REPORT, Report, ReportSettings, Trial};
use evaluation::trials::Experiment;
use interfaces::SettingsError;
use mapper::{EstimatorChoice, MapperSettings, Paper};
use sim::grid::{GenerateSettings, GridSpec};
use std::collections::BTreeSet;
use std::io::stderr;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use viewer::recording::{Recorder, RecordingError};
use viewer::trial::{Recorded, record};

fn main() -> ExitCode {
    start(|args: &Args| {
        if args.list_worlds {
            list(&worlds::SHIPPED_GRID, 20, |name| worlds::load_grid(name).map(|spec| spec.description))?;
            return Ok(ExitCode::SUCCESS);
        }
        let experiment = experiment(args).map_err(Failure::Input)?;
        Ok(run(args, &experiment)?)
    })
}

/// The experiment that the arguments describe.
fn experiment(args: &Args) -> anyhow::Result<Experiment> {
    let mut estimators = args.estimator.clone();
    if estimators.is_empty() {
        estimators = vec![Paper.into(), EstimatorChoice::default()];
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

/// The named worlds, then the generated worlds, with the changes that the arguments ask for.
fn worlds(args: &Args) -> anyhow::Result<Vec<GridSpec>> {
    let mut names: Vec<&str> = args.world.iter().map(String::as_str).collect();
    if names.is_empty() && args.generate.is_none() {
        names.push(worlds::SHIPPED_GRID[0].0);
    }
    let mut worlds = distinct(names).into_iter().map(worlds::load_grid).collect::<Result<Vec<_>, _>>()?;
    let settings = GenerateSettings::default();
    let generated = 0..args.generate.unwrap_or(0);
    worlds.extend(generated.map(|number| GridSpec::generate(&settings, args.seed.wrapping_add(number))));
    let mut names = BTreeSet::new();
    if let Some(twin) = worlds.iter().map(|world| &world.name).find(|name| !names.insert(*name)) {
        bail!(
            "two worlds have the name `{twin}`: results are listed by name, so give each world its own name"
        );
    }
    for world in &mut worlds {
        for warning in world.warnings().iter().filter(|_| !args.quiet) {
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

/// Every value once, in the order of first occurrence.
fn distinct<T: PartialEq>(values: Vec<T>) -> Vec<T> {
    let mut distinct = Vec::new();
    for value in values {
        if !distinct.contains(&value) {
            distinct.push(value);
        }
    }
    distinct
}

/// Runs the trials; the first trial is recorded if `--rrd` is given. A failure of the recording is returned
/// together with the trials, so that no trial is lost.
fn trials(
    args: &Args,
    experiment: &Experiment,
    is_canceled: &AtomicBool,
) -> anyhow::Result<(Vec<Trial>, Option<RecordingError>)> {
    let threads = usize::from(args.threads.unwrap_or(0)); // 0: the number of cores
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().context("cannot start threads")?;
    let mut jobs = experiment.jobs();
    let progress = Progress::of_trials(jobs.len(), args.quiet);
    let first = match &args.rrd {
        None => None,
        Some(file) => {
            let trial = jobs.remove(0);
            Some((Recorder::new(Some(file), &[], trial.world.into())?, trial))
        }
    };
    let record = || -> Result<_, SettingsError> {
        let Some((recorder, settings)) = first else { return Ok((None, None)) };
        let Recorded { trial, problem } = record(&settings, recorder, is_canceled)?;
        trial.iter().for_each(|_| progress.step());
        Ok((trial, problem))
    };
    let run = || experiment.run(jobs, is_canceled, |_| progress.step());
    let (first, others) = pool.install(|| rayon::join(record, run));
    progress.finish();
    let (first, problem) = first?;
    Ok((first.into_iter().chain(others?).collect(), problem))
}

/// Runs the trials, and writes the results.
fn run(args: &Args, experiment: &Experiment) -> anyhow::Result<ExitCode> {
    let is_canceled = interrupt_flag()?; // before any file is made
    let mut folder = RunFolder::open(&args.out)?;
    args.rrd.iter().try_for_each(|path| folder.adopt(path, "rrd"))?;
    let (trials, problem) = trials(args, experiment, &is_canceled)?;
    let is_interrupted = is_canceled.load(Ordering::Relaxed);
    if trials.is_empty() {
        say(stderr(), "interrupted before the first trial was finished: no report");
        return Ok(ExitCode::from(INTERRUPTED));
    }
    if args.save_worlds {
        let named = experiment.worlds.len() - args.generate.unwrap_or(0) as usize;
        for world in &experiment.worlds[named..] {
            let path = folder.unfinished().join(format!("{}.toml", world.name));
            write_file(&path, |file| file.write_all(worldfile::grid::to_toml(world).as_bytes()))?;
        }
    }
    let settings = ReportSettings {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        arguments: std::env::args().skip(1).collect(),
        interrupted: is_interrupted,
        ..experiment.report_settings()
    };
    let report = Report::new(settings, trials);
    let names = report.write(&folder, &experiment.worlds)?;
    let inputs: Vec<&Path> = args.world.iter().map(Path::new).collect();
    folder.finish(REPORT, &inputs)?;
    if !args.quiet {
        print(report.table())?;
        print(format_args!("written to {}: {}", args.out.display(), names.join(", ")))?;
    }
    if let Some(problem) = problem {
        return Err(problem.into());
    }
    Ok(if is_interrupted { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
}

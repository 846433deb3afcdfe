//! Code that the programs of trials share: options, and the way from trials to results.

use crate::program::{INTERRUPTED, strategy_of};
use crate::progress::Progress;
use crate::terminal::{print, say};
use agent::Reward;
use anyhow::{Context, bail};
use clap::builder::TypedValueParser;
use clap::{Args, ValueEnum};
use evaluation::output::{RunFolder, write_file};
use evaluation::report::{Plan, REPORT, Report, ReportSettings, Trial};
use evaluation::trials::{Experiment, TrialError, TrialStrategy, TrialWorld};
use std::collections::BTreeSet;
use std::io::stderr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use viewer::recording::{Recorder, RecordingError};
use viewer::scene::{Scene, Visible};
use viewer::trial::{Recorded, record};

/// Options of all programs of trials.
#[derive(Clone, Debug, Args)]
pub struct TrialArgs {
    /// Generate N random worlds, from --seed on
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000), help_heading = "World")]
    pub generate: Option<u64>,

    /// The seed of all random streams: equal seeds give equal results, on any number of threads
    #[arg(long, default_value_t = 0, help_heading = "Comparison")]
    pub seed: u64,

    /// The reward of the learner
    #[arg(long, value_enum, default_value_t = RewardChoice::Changes, help_heading = "Comparison")]
    pub reward: RewardChoice,

    /// The number of threads [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), help_heading = "Execution")]
    pub threads: Option<u16>,

    /// Record the first trial, at most 20,000 readings; open the recording with `rerun FILE`
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub rrd: Option<PathBuf>,

    /// Save the generated worlds as TOML files in the output folder
    #[arg(long, requires = "generate", help_heading = "Output")]
    pub save_worlds: bool,

    /// Print only errors
    #[arg(long, short, help_heading = "Output")]
    pub quiet: bool,
}

/// What counts as a map update when the learner is rewarded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RewardChoice {
    /// Cells that changed
    Changes,
    /// Cells that changed, and cells that were seen for the first time
    ChangesAndDiscoveries,
}

impl From<RewardChoice> for Reward {
    fn from(choice: RewardChoice) -> Self {
        match choice {
            RewardChoice::Changes => Self::Changes,
            RewardChoice::ChangesAndDiscoveries => Self::ChangesAndDiscoveries,
        }
    }
}

/// A parser of the name of a strategy, or of a reference.
pub fn strategies() -> impl TypedValueParser<Value = TrialStrategy> {
    strategy_of(TrialStrategy::all().collect(), |strategy| (strategy.name(), strategy.description()))
}

/// Every value once, in the order of first occurrence.
pub fn distinct<T: PartialEq>(values: Vec<T>) -> Vec<T> {
    let mut distinct = Vec::new();
    for value in values {
        if !distinct.contains(&value) {
            distinct.push(value);
        }
    }
    distinct
}

/// The named worlds, and after them the generated worlds; `default` if there are none of both.
///
/// # Errors
///
/// When a world cannot be loaded, and when two worlds have the same name.
pub fn worlds<W: TrialWorld, E: Into<anyhow::Error>>(
    args: &TrialArgs,
    names: &[String],
    default: Option<&str>,
    load: impl Fn(&str) -> Result<W, E>,
    generate: impl Fn(u64) -> W,
) -> anyhow::Result<Vec<W>> {
    let mut names: Vec<&str> = names.iter().map(String::as_str).collect();
    if names.is_empty() && args.generate.is_none() {
        names.extend(default);
    }
    let worlds: Result<Vec<W>, E> = distinct(names).into_iter().map(load).collect();
    let mut worlds = worlds.map_err(Into::into)?;
    let generated = 0..args.generate.unwrap_or(0);
    worlds.extend(generated.map(|number| generate(args.seed.wrapping_add(number))));
    let mut names = BTreeSet::new();
    if let Some(twin) = worlds.iter().map(W::name).find(|name| !names.insert(*name)) {
        bail!(
            "two worlds have the name `{twin}`: results are listed by name, so give each world its own name"
        );
    }
    Ok(worlds)
}

/// Runs the trials; the first trial is recorded if `--rrd` is given. A failure of the recording is returned
/// together with the trials, so that no trial is lost.
fn trials<W: TrialWorld<World: Visible>>(
    args: &TrialArgs,
    experiment: &Experiment<W>,
    is_canceled: &AtomicBool,
) -> anyhow::Result<(Vec<Trial>, Option<RecordingError>)>
where
    for<'a> Scene: From<&'a W>,
{
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
    let record = || -> Result<_, TrialError> {
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

/// Runs the trials, and writes the results into the folder `out`. `names` are the worlds as given, and `to_toml` is
/// the text of the file of a generated world.
///
/// # Errors
///
/// When a trial cannot run, or results cannot be written.
pub fn run<W: TrialWorld<World: Visible>>(
    args: &TrialArgs,
    out: &Path,
    names: &[String],
    experiment: &Experiment<W>,
    is_canceled: &AtomicBool,
    to_toml: impl Fn(&W) -> Option<String>,
) -> anyhow::Result<ExitCode>
where
    for<'a> Scene: From<&'a W>,
    for<'a> Plan<'a>: From<&'a W>,
{
    let mut folder = RunFolder::open(out)?;
    args.rrd.iter().try_for_each(|path| folder.adopt(path, "rrd"))?;
    let (trials, problem) = trials(args, experiment, is_canceled)?;
    let is_interrupted = is_canceled.load(Ordering::Relaxed);
    if trials.is_empty() {
        say(stderr(), "interrupted before the first trial was finished: no report");
        return Ok(ExitCode::from(INTERRUPTED));
    }
    if args.save_worlds {
        let named = experiment.worlds.len() - args.generate.unwrap_or(0) as usize;
        for world in &experiment.worlds[named..] {
            let path = folder.unfinished().join(format!("{}.toml", world.name()));
            let text = to_toml(world).context("a generated world cannot be written as a file")?;
            write_file(&path, |file| file.write_all(text.as_bytes()))?;
        }
    }
    let settings = ReportSettings {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        arguments: std::env::args().skip(1).collect(),
        interrupted: is_interrupted,
        ..experiment.report_settings()
    };
    let report = Report::new(settings, trials);
    let written = report.write(&folder, &experiment.worlds)?;
    let inputs: Vec<&Path> = names.iter().map(Path::new).collect();
    folder.finish(REPORT, &inputs)?;
    if !args.quiet {
        print(report.table())?;
        print(format_args!("written to {}: {}", out.display(), written.join(", ")))?;
    }
    if let Some(problem) = problem {
        return Err(problem.into());
    }
    Ok(if is_interrupted { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
}

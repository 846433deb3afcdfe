//! Code that the programs of trials share: options, and the way from trials to results.

use crate::flags::{output_file, value_of};
use crate::program::{Failure, INTERRUPTED, input, results_folder, strategy_of};
use crate::progress::Progress;
use crate::terminal::{print, say};
use agent::Reward;
use anyhow::{Context, bail};
use clap::builder::TypedValueParser;
use clap::parser::ValueSource;
use clap::{Args, Parser, ValueEnum};
use evaluation::trials::{Experiment, Trial, TrialError, TrialStrategy, TrialWorld};
use rayon::ThreadPool;
use reports::shards::Shard;
use reports::{Plan, ReportSettings, collect};
use results::output::{RunFolder, write_file};
use std::collections::BTreeSet;
use std::fmt::Debug;
use std::io::stderr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use viewer::recording::{Recorder, RecordingError};
use viewer::scene::{Scene, Visible};
use viewer::trial::{Recorded, record};

/// The groups of options that do not change the results of an experiment.
const OUTPUT: &str = "Output";
const EXECUTION: &str = "Execution";

/// Options of all programs of trials.
#[derive(Clone, Debug, Args)]
pub struct TrialArgs {
    /// Generate N random worlds, from --seed on
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000), allow_negative_numbers = true, help_heading = "World")]
    pub generate: Option<u64>,

    /// The seed of all random streams: equal seeds give equal results, on any number of threads
    #[arg(long, default_value_t = 0, allow_negative_numbers = true, help_heading = "Comparison")]
    pub seed: u64,

    /// The reward of the learner
    #[arg(long, value_enum, default_value_t = RewardChoice::Changes, help_heading = "Comparison")]
    pub reward: RewardChoice,

    /// The number of threads [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024), allow_negative_numbers = true, help_heading = EXECUTION)]
    pub threads: Option<u16>,

    /// Run shard I of N: every N-th trial, into a file of its own in --out. Run shards 1/N to N/N on any machines, then
    /// `merge`. A shard that is started again goes on where it ended
    #[arg(long, value_name = "I/N", conflicts_with_all = ["rrd", "save_worlds"], help_heading = EXECUTION)]
    pub shard: Option<Shard>,

    /// Go on in a folder with shards of another build of this program; the results are those of neither build
    #[arg(long, requires = "shard", help_heading = EXECUTION)]
    pub allow_other_build: bool,

    /// Record the first trial, at most 20,000 readings; open the recording with `rerun FILE`
    #[arg(long, value_name = "FILE", value_parser = output_file(), help_heading = OUTPUT)]
    pub rrd: Option<PathBuf>,

    /// Save the generated worlds as TOML files in the output folder
    #[arg(long, requires = "generate", help_heading = OUTPUT)]
    pub save_worlds: bool,

    /// Print only errors
    #[arg(long, short, help_heading = OUTPUT)]
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

/// The command line of a program of trials.
pub trait TrialProgram: Parser {
    /// The worlds of the program.
    type Spec: TrialWorld<World: Visible, Robot: Debug> + Debug;

    /// The options of all programs of trials.
    fn shared(&self) -> &TrialArgs;

    /// The folder for all results.
    fn out(&self) -> &Path;

    /// The worlds as given.
    fn world_names(&self) -> &[String];

    /// The experiment that the arguments describe.
    ///
    /// # Errors
    ///
    /// When a world cannot be loaded.
    fn experiment(&self) -> anyhow::Result<Experiment<Self::Spec>>;

    /// The text of the file of a generated world.
    fn to_toml(world: &Self::Spec) -> Option<String>;
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
    let mut worlds = worlds.map_err(|error| value_of("--world", error))?;
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

/// The arguments that describe the experiment: those on output and execution are left out, so that equal experiments
/// have equal arguments.
pub(crate) fn experiment_arguments<P: Parser>() -> Vec<String> {
    given_arguments::<P>(&[OUTPUT, EXECUTION])
}

/// The arguments on the command line, in the order of the help, without those under the headings `left_out`.
fn given_arguments<P: Parser>(left_out: &[&str]) -> Vec<String> {
    let command = P::command();
    let Ok(matches) = command.clone().try_get_matches_from(std::env::args_os()) else { return Vec::new() };
    let mut arguments = Vec::new();
    for option in command.get_arguments() {
        let id = option.get_id().as_str();
        let is_left_out = option.get_help_heading().is_some_and(|heading| left_out.contains(&heading));
        let Some(name) = option.get_long().filter(|_| !is_left_out) else { continue };
        if matches.value_source(id) != Some(ValueSource::CommandLine) {
            continue;
        }
        for values in matches.get_raw_occurrences(id).into_iter().flatten() {
            arguments.push(format!("--{name}"));
            arguments.extend(values.map(|value| value.to_string_lossy().into_owned()));
        }
    }
    arguments
}

/// The settings of the report of an experiment.
pub(crate) fn report_settings<W: TrialWorld>(
    experiment: &Experiment<W>,
    arguments: Vec<String>,
) -> ReportSettings {
    let version = env!("CARGO_PKG_VERSION").to_owned();
    ReportSettings { version, arguments, ..ReportSettings::of(experiment) }
}

/// The threads that run trials.
pub(crate) fn threads(args: &TrialArgs) -> anyhow::Result<ThreadPool> {
    let threads = usize::from(args.threads.unwrap_or(0)); // 0: the number of cores
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().context("cannot start threads")
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
    let pool = threads(args)?;
    let mut jobs = experiment.jobs();
    let progress = Progress::of_trials(jobs.len(), args.quiet);
    let first = match &args.rrd {
        None => None,
        Some(file) => {
            let trial = jobs.remove(0);
            let own = trial.world.in_own_frame(&experiment.robot, trial.seed);
            let scene = own.as_ref().unwrap_or(trial.world).into();
            Some((Recorder::new(Some(file), &[], scene)?, trial))
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

/// Runs the trials, and writes the results.
pub(crate) fn run<P: TrialProgram>(
    program: &P,
    experiment: &Experiment<P::Spec>,
    is_canceled: &AtomicBool,
) -> Result<ExitCode, Failure>
where
    for<'a> Scene: From<&'a P::Spec>,
    for<'a> Plan<'a>: From<&'a P::Spec>,
{
    let args = program.shared();
    let mut folder = results_folder(program.out())?;
    args.rrd.iter().try_for_each(|path| folder.adopt(path, "rrd")).map_err(input)?;
    let (mut trials, problem) = trials(args, experiment, is_canceled)?;
    let interrupted = is_canceled.load(Ordering::Relaxed);
    if trials.is_empty() {
        say(stderr(), "interrupted before the first trial was finished: no report");
        return Ok(ExitCode::from(INTERRUPTED));
    }
    if args.save_worlds {
        let named = experiment.worlds.len() - args.generate.unwrap_or(0) as usize;
        for world in &experiment.worlds[named..] {
            let path = folder.unfinished().join(format!("{}.toml", world.name()));
            let text = P::to_toml(world).context("a generated world cannot be written as a file")?;
            write_file(&path, |file| file.write_all(text.as_bytes()))?;
        }
    }
    let settings = ReportSettings { interrupted, ..report_settings(experiment, experiment_arguments::<P>()) };
    settings.sort(&mut trials);
    let results =
        Results { folder, out: program.out(), world_names: program.world_names(), quiet: args.quiet };
    results.write(settings, trials.into_iter().map(Ok), &experiment.worlds)?;
    if let Some(problem) = problem {
        return Err(Failure::Run(problem.into()));
    }
    Ok(if interrupted { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
}

/// Where results go.
pub(crate) struct Results<'a> {
    pub(crate) folder: RunFolder,
    pub(crate) out: &'a Path,
    /// The worlds as given: files that stay.
    pub(crate) world_names: &'a [String],
    pub(crate) quiet: bool,
}

impl Results<'_> {
    /// Writes the results of trials, which come in the order of the report, and prints the table.
    pub(crate) fn write<'w, W>(
        self,
        settings: ReportSettings,
        trials: impl Iterator<Item = anyhow::Result<Trial>>,
        worlds: &'w [W],
    ) -> Result<(), Failure>
    where
        Plan<'w>: From<&'w W>,
    {
        let report = collect(settings, self.folder.unfinished(), trials)?;
        let written = report.write(&self.folder, worlds).map_err(anyhow::Error::from)?;
        let inputs: Vec<&Path> = self.world_names.iter().map(Path::new).collect();
        self.folder.finish(&inputs)?;
        if !self.quiet {
            print(report.table())?;
            print(format_args!("written to {}: {}", self.out.display(), written.join(", ")))?;
        }
        Ok(())
    }
}

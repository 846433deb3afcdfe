//! Experiments in shards: the option `--shard`, and the subcommands on a folder of shards.

mod status;

use crate::flags::folder;
use crate::program::{Failure, INTERRUPTED, input, interrupt_flag, results_folder};
use crate::progress::Progress;
use crate::terminal::{print, say};
use crate::trials::{self, Results, TrialProgram, experiment_arguments, report_settings, threads};
use anyhow::{Context, anyhow};
use clap::Subcommand;
use evaluation::trials::{Experiment, TrialSettings, TrialWorld, run_trial};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use reports::shards::{Cost, Header, SEVERAL_BUILDS, Shard, ShardFile, Shards, array, check_builds};
use reports::{Plan, ReportSettings};
use std::io::stderr;
use std::iter::once;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Instant, SystemTime};
use viewer::scene::Scene;

/// What can be done with a folder of shards.
#[derive(Clone, Debug, Subcommand)]
pub enum ShardCommand {
    /// Print the shards that are not complete, as `sbatch --array` reads them; exit code 1 if there are any
    ///
    /// The output is one line, as in 2,5-7, or nothing if all shards are complete. To run those shards again:
    ///
    ///   sbatch --array=$(PROGRAM missing DIR) shards.sh
    ///
    /// A shard that is started again goes on where it ended. While shards run they count as not complete.
    #[command(verbatim_doc_comment)]
    Missing {
        /// The folder of the shards
        dir: PathBuf,
    },
    /// Write the results of all shards: the same files, byte by byte, as those of a run without shards
    ///
    /// The shards must be complete, of one experiment, and of this build of the program; otherwise the file with the
    /// problem is named, and nothing is written. World files must be where they were when the shards ran. The files of
    /// the shards stay.
    Merge {
        /// The folder of the shards
        dir: PathBuf,

        /// The folder for the results [default: the folder of the shards]
        #[arg(long, value_name = "DIR", value_parser = folder())]
        out: Option<PathBuf>,

        /// Merge shards of other builds of this program; the results are those of no build
        #[arg(long)]
        allow_other_build: bool,

        /// Print only errors
        #[arg(long, short)]
        quiet: bool,
    },
    /// Print what is finished, what runs, and the time that remains; also while shards run
    ///
    /// A shard counts as running while its newest trial is not older than five trials take, and at least one minute.
    /// The cost is the wall time of all trials on their threads.
    Status {
        /// The folder of the shards
        dir: PathBuf,
    },
}

/// Runs what the command line of a program of trials asks for: a subcommand on shards, a shard, or all trials.
///
/// # Errors
///
/// When the input is invalid, a trial cannot run, or results cannot be written.
pub fn main<P: TrialProgram>(args: &P, command: Option<&ShardCommand>) -> Result<ExitCode, Failure>
where
    for<'a> Scene: From<&'a P::Spec>,
    for<'a> Plan<'a>: From<&'a P::Spec>,
{
    if let Some(command) = command {
        return manage::<P>(command);
    }
    let experiment = args.experiment().map_err(input)?;
    let is_canceled = interrupt_flag()?; // before any file is made
    match args.shared().shard {
        Some(shard) => run_shard(args, shard, &experiment, &is_canceled),
        None => trials::run(args, &experiment, &is_canceled),
    }
}

/// The header of the files of the shards of an experiment.
fn header<P: TrialProgram>(arguments: Vec<String>, shard: Shard, experiment: &Experiment<P::Spec>) -> Header {
    let program = P::command().get_name().to_owned();
    let trials = experiment.jobs().len() as u64;
    Header::new(&program, env!("CARGO_PKG_VERSION"), arguments, experiment, trials, shard)
}

/// Runs the trials of a shard that are not finished yet.
fn run_shard<P: TrialProgram>(
    program: &P,
    shard: Shard,
    experiment: &Experiment<P::Spec>,
    is_canceled: &AtomicBool,
) -> Result<ExitCode, Failure> {
    let args = program.shared();
    let header = header::<P>(experiment_arguments::<P>(), shard, experiment);
    if !args.allow_other_build {
        check_builds(program.out()).map_err(input)?;
    }
    let file = ShardFile::open(program.out(), &header, shard).map_err(input)?;
    let all = shard.trials(header.trials);
    let mut jobs = experiment.jobs();
    jobs.retain(|job| shard.has(job.number) && !file.finished().contains(&job.number));
    jobs.sort_by_key(|job| job.number); // the order in which `merge` reads
    let before = all - jobs.len() as u64;
    if !args.quiet && before > 0 {
        say(stderr(), format_args!("shard {shard}: {before} of {all} trials are finished already"));
    }
    let progress = Progress::of_trials(jobs.len(), args.quiet);
    let run = |job| {
        let ran = run_job(&job, &file, is_canceled);
        match ran {
            Ok(true) => progress.step(),
            Ok(false) => {}
            Err(_) => is_canceled.store(true, Ordering::Relaxed), // the other trials cannot be written either
        }
        ran.map(u64::from)
    };
    let finished = threads(args)?.install(|| jobs.into_par_iter().map(run).collect::<Vec<_>>());
    progress.finish();
    let finished = before + finished.into_iter().sum::<anyhow::Result<u64>>()?;
    file.sync().context("start the shard again")?;
    if finished < all {
        let again = "start the shard again to go on";
        say(
            stderr(),
            format_args!("interrupted: {finished} of {all} trials of shard {shard} are finished; {again}"),
        );
        return Ok(ExitCode::from(INTERRUPTED));
    }
    if !args.quiet {
        print(format_args!("shard {shard} is complete: {all} trials in {}", file.path().display()))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Runs one trial and appends it to the file; false if it was canceled.
fn run_job<W: TrialWorld>(
    job: &TrialSettings<W>,
    file: &ShardFile,
    is_canceled: &AtomicBool,
) -> anyhow::Result<bool> {
    let goes_on = || !is_canceled.load(Ordering::Relaxed);
    let start = Instant::now();
    let Some(trial) = goes_on().then(|| run_trial(job, |_| goes_on())).transpose()?.flatten() else {
        return Ok(false);
    };
    let cost = Cost { seconds: start.elapsed().as_secs_f64(), finished: now() };
    let lost = "free space, and start the shard again: the trials before are kept";
    file.append(job.number, cost, &trial).map_err(|error| anyhow!("{error}; {lost}"))?;
    Ok(true)
}

/// The time, s since 1970.
fn now() -> u64 {
    SystemTime::UNIX_EPOCH.elapsed().map_or(0, |time| time.as_secs())
}

/// Carries out a subcommand.
fn manage<P: TrialProgram>(command: &ShardCommand) -> Result<ExitCode, Failure>
where
    for<'a> Plan<'a>: From<&'a P::Spec>,
{
    match command {
        ShardCommand::Missing { dir } => {
            let missing = Shards::read(dir).map_err(input)?.missing();
            if missing.is_empty() {
                return Ok(ExitCode::SUCCESS);
            }
            print(array(&missing))?;
            Ok(ExitCode::FAILURE)
        }
        ShardCommand::Merge { dir, out, allow_other_build, quiet } => {
            merge::<P>(dir, out.as_deref().unwrap_or(dir), *allow_other_build, *quiet)
        }
        ShardCommand::Status { dir } => {
            print(status::status(&Shards::read(dir).map_err(input)?, now()))?;
            Ok(ExitCode::SUCCESS)
        }
    }
}

fn merge<P: TrialProgram>(
    dir: &Path,
    out: &Path,
    allows_other_build: bool,
    quiet: bool,
) -> Result<ExitCode, Failure>
where
    for<'a> Plan<'a>: From<&'a P::Spec>,
{
    let shards = Shards::read(dir).map_err(input)?;
    let name = P::command().get_name().to_owned();
    let found = shards.header();
    let shown = dir.display();
    if found.program != name {
        let right = &found.program;
        return Err(input(anyhow!("{shown} has shards of {right}: merge them with `{right} merge {shown}`")));
    }
    if found.version != env!("CARGO_PKG_VERSION") {
        let version = &found.version;
        return Err(input(anyhow!("{shown} has shards of version {version}: merge them with that version")));
    }
    let other_build = match check_builds(dir) {
        Err(_) if allows_other_build => Some(SEVERAL_BUILDS),
        checked => checked.map(|()| None).map_err(input)?,
    };
    let missing = shards.missing();
    if let [first, ..] = missing[..] {
        let count = found.shard().map_or(0, Shard::count);
        let file = Shard::new(first, count).map(Shard::file_name).unwrap_or_default();
        let missing = array(&missing);
        let which = format!("the shards {missing} of {count} lack trials, the first is {file}");
        return Err(input(anyhow!("{shown} is not complete: {which}; run those shards again")));
    }
    let args = P::try_parse_from(once(&name).chain(&found.arguments));
    let args = args.context("the arguments of the shards are not valid").map_err(input)?;
    let experiment = args.experiment().map_err(input)?;
    let shard = found.shard().context("the number of the shard is not valid")?;
    if !header::<P>(found.arguments.clone(), shard, &experiment).is_same_experiment(found) {
        let why = "a world file was changed after the shards ran, or the program is another one";
        return Err(input(anyhow!("the experiment of {shown} cannot be repeated: {why}")));
    }
    let arguments = found.arguments.clone();
    let settings = ReportSettings { other_build, ..report_settings(&experiment, arguments) };
    let folder = results_folder(out).map_err(|(Failure::Run(why) | Failure::Input(why))| input(why))?;
    let results = Results { folder, out, world_names: args.world_names(), quiet };
    let trials = shards.trials().map_err(input)?.map(|trial| trial.map_err(Into::into));
    results.write(settings, trials, &experiment.worlds)?;
    Ok(ExitCode::SUCCESS)
}

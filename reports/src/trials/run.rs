//! Arguments → trials → report.

use super::{EXECUTION, OUTPUT, TrialArgs, TrialKind};
use crate::shards::{Header, Shard, ShardFile, Shards};
use crate::{REPORT, ReportSettings, collect};
use anyhow::{Context, anyhow};
use clap::parser::ValueSource;
use clap::{CommandFactory, Parser, Subcommand};
use cli::flags::folder;
use cli::program::{Failure, INTERRUPTED, input, interrupt_flag, results_folder, start};
use cli::progress::Progress;
use cli::terminal::{be_quiet, print, print_lines, say};
use evaluation::scenes::Displayed;
use evaluation::trials::{Experiment, Trial, TrialWorld};
use files::{RunFolder, write_file};
use rayon::ThreadPool;
use std::io::stderr;
use std::iter::once;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

/// The program: it runs what the command line asks for, and returns its exit code.
pub fn main<K: TrialKind>() -> ExitCode {
    start(|args: &TrialArgs<K>| {
        if args.list_worlds {
            K::list_worlds()?;
            return Ok(ExitCode::SUCCESS);
        }
        if let Some(command) = &args.command {
            return command.run::<K>();
        }
        be_quiet(args.quiet);
        let experiment = args.experiment().map_err(input)?;
        let is_canceled = interrupt_flag()?; // before any file is made
        match args.shard {
            Some(shard) => args.run_shard(shard, &experiment, &is_canceled),
            None => args.run(&experiment, &is_canceled),
        }
    })
}

impl<K: TrialKind> TrialArgs<K> {
    /// Runs the trials, and writes the results.
    fn run(&self, experiment: &Experiment<K::Spec>, is_canceled: &AtomicBool) -> Result<ExitCode, Failure> {
        let folder = results_folder(&self.out)?;
        let jobs = experiment.jobs();
        let progress = Progress::of_count(jobs.len(), "trials");
        let run = || experiment.run(jobs, is_canceled, |_| progress.step());
        let mut trials = self.pool()?.install(run).map_err(anyhow::Error::from)?;
        drop(progress);
        let interrupted = is_canceled.load(Ordering::Relaxed);
        if trials.is_empty() {
            say(stderr(), "interrupted before the first trial was finished: no report");
            return Ok(ExitCode::from(INTERRUPTED));
        }
        if self.save_worlds {
            self.save_worlds(experiment, &folder)?;
        }
        let arguments = experiment_arguments::<K>();
        let settings = ReportSettings { interrupted, ..report_settings(experiment, arguments) };
        settings.sort(&mut trials);
        let results = Results { folder, out: &self.out, world_names: &self.world };
        results.write(settings, &trials, &experiment.worlds)?;
        Ok(if interrupted { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
    }

    /// Writes the files of the generated worlds.
    fn save_worlds(&self, experiment: &Experiment<K::Spec>, folder: &RunFolder) -> anyhow::Result<()> {
        let named = experiment.worlds.len() - self.generate.unwrap_or(0) as usize;
        for world in &experiment.worlds[named..] {
            let path = folder.unfinished().join(format!("{}.toml", world.name()));
            let text = K::to_toml(world).context("a generated world cannot be written as a file")?;
            write_file(&path, |file| file.write_all(text.as_bytes()))?;
        }
        Ok(())
    }

    /// The threads that run trials.
    pub(super) fn pool(&self) -> anyhow::Result<ThreadPool> {
        let threads = usize::from(self.threads.unwrap_or(0)); // 0: the number of cores
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().context("cannot start threads")
    }
}

/// The arguments that describe the experiment, in the order of the help: those on output and execution are left out, so
/// that equal experiments have equal arguments.
pub(super) fn experiment_arguments<K: TrialKind>() -> Vec<String> {
    let command = TrialArgs::<K>::command();
    let Ok(matches) = command.clone().try_get_matches_from(std::env::args_os()) else { return Vec::new() };
    let mut arguments = Vec::new();
    for option in command.get_arguments() {
        let id = option.get_id().as_str();
        let is_left_out =
            option.get_help_heading().is_some_and(|heading| [OUTPUT, EXECUTION].contains(&heading));
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
pub(super) fn report_settings<W: TrialWorld>(
    experiment: &Experiment<W>,
    arguments: Vec<String>,
) -> ReportSettings {
    let version = env!("CARGO_PKG_VERSION").to_owned();
    ReportSettings { version, arguments, ..ReportSettings::of(experiment) }
}

/// Where results go.
pub(super) struct Results<'a> {
    pub(super) folder: RunFolder,
    pub(super) out: &'a Path,
    /// The worlds as given: files that stay.
    pub(super) world_names: &'a [String],
}

impl Results<'_> {
    /// Writes the results of trials, which come in the order of the report, and prints the table.
    pub(super) fn write<W: Displayed>(
        self,
        settings: ReportSettings,
        trials: &[Trial],
        worlds: &[W],
    ) -> Result<(), Failure> {
        let report = collect::<anyhow::Error>(settings, self.folder.unfinished(), trials)?;
        let written = report.write(&self.folder, worlds).map_err(anyhow::Error::from)?;
        let inputs: Vec<&Path> = self.world_names.iter().map(Path::new).collect();
        self.folder.finish(&inputs)?;
        print_lines(report.table())?;
        if report.leaves_out_worlds() {
            print_lines(format_args!("The worlds one by one are in {REPORT}.\n"))?;
        }
        print(format_args!("written to {}: {}", self.out.display(), written.join(", ")))?;
        Ok(())
    }
}

// Experiments in shards: the option `--shard`, and the subcommands on a folder of shards.

/// What can be done with a folder of shards.
#[derive(Clone, Debug, Subcommand)]
pub(super) enum ShardCommand {
    /// Write the results of all shards: the same files, byte by byte, as those of a run without shards
    ///
    /// All shards must be there, of one experiment, and of this build of the program; otherwise the file with the
    /// problem, or the missing shards are named, and nothing is written. World files must be where they were when the shards ran. The files of
    /// the shards stay.
    Merge {
        /// The folder of the shards
        dir: PathBuf,

        /// The folder for the results [default: the folder of the shards]
        #[arg(long, value_name = "DIR", value_parser = folder())]
        out: Option<PathBuf>,

        /// Print only errors
        #[arg(long, short)]
        quiet: bool,
    },
}

impl ShardCommand {
    /// Carries out the subcommand.
    pub(super) fn run<K: TrialKind>(&self) -> Result<ExitCode, Failure> {
        let Self::Merge { dir, out, quiet } = self;
        be_quiet(*quiet);
        merge::<K>(dir, out.as_deref().unwrap_or(dir))?;
        Ok(ExitCode::SUCCESS)
    }
}

fn merge<K: TrialKind>(dir: &Path, out: &Path) -> Result<(), Failure> {
    let shards = Shards::read(dir).map_err(input)?;
    shards.check(K::NAME, env!("CARGO_PKG_VERSION")).map_err(input)?;
    let found = &shards.header;
    let args =
        TrialArgs::<K>::try_parse_from(once(K::NAME).chain(found.arguments.iter().map(String::as_str)));
    let args = args.context("the arguments of the shards are not valid").map_err(input)?;
    let experiment = args.experiment().map_err(input)?;
    if header::<K>(found.arguments.clone(), found.shard, &experiment).difference(found).is_some() {
        let why = "a world file was changed after the shards ran, or the program is another one";
        return Err(input(anyhow!("the experiment of {} cannot be repeated: {why}", dir.display())));
    }
    let arguments = found.arguments.clone();
    let settings = report_settings(&experiment, arguments);
    let mut trials = shards.trials(&experiment).map_err(input)?;
    settings.sort(&mut trials);
    let folder = results_folder(out).map_err(|(Failure::Run(why) | Failure::Input(why))| input(why))?;
    let results = Results { folder, out, world_names: &args.world };
    results.write(settings, &trials, &experiment.worlds)
}

/// The header of the files of the shards of an experiment.
fn header<K: TrialKind>(arguments: Vec<String>, shard: Shard, experiment: &Experiment<K::Spec>) -> Header {
    let trials = experiment.jobs().len() as u64;
    Header::new(K::NAME, env!("CARGO_PKG_VERSION"), arguments, experiment, trials, shard)
}

impl<K: TrialKind> TrialArgs<K> {
    /// Runs the trials of a shard, unless it is complete.
    pub(super) fn run_shard(
        &self,
        shard: Shard,
        experiment: &Experiment<K::Spec>,
        is_canceled: &AtomicBool,
    ) -> Result<ExitCode, Failure> {
        let header = header::<K>(experiment_arguments::<K>(), shard, experiment);
        let Some(file) = ShardFile::open(&self.out, &header).map_err(input)? else {
            print(format_args!("shard {shard} is complete already"))?;
            return Ok(ExitCode::SUCCESS);
        };
        let mut jobs = experiment.jobs();
        jobs.retain(|trial| shard.has(trial.number));
        let progress = Progress::of_count(jobs.len(), "trials");
        let run = || experiment.run(jobs, is_canceled, |_| progress.step());
        let trials = self.pool()?.install(run).map_err(anyhow::Error::from)?;
        drop(progress);
        if is_canceled.load(Ordering::Relaxed) {
            say(stderr(), format_args!("interrupted: start shard {shard} again, nothing of it is kept"));
            return Ok(ExitCode::from(INTERRUPTED));
        }
        let path = file.path.clone();
        file.write(&trials).map_err(anyhow::Error::from)?;
        print(format_args!("shard {shard} is complete: {} trials in {}", trials.len(), path.display()))?;
        Ok(ExitCode::SUCCESS)
    }
}

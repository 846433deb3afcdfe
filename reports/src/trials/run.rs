//! Arguments → trials → report.

use super::{EXECUTION, OUTPUT, TrialArgs, TrialKind};
use crate::{REPORT, ReportSettings, collect};
use anyhow::Context;
use clap::CommandFactory;
use clap::parser::ValueSource;
use cli::program::{Failure, INTERRUPTED, input, interrupt_flag, results_folder, start};
use cli::progress::Progress;
use cli::terminal::{print, say};
use evaluation::scenes::Displayed;
use evaluation::trials::{Experiment, Trial, TrialWorld};
use files::{RunFolder, write_file};
use rayon::ThreadPool;
use std::io::stderr;
use std::path::Path;
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
        let progress = Progress::of_count(jobs.len(), "trials", self.quiet);
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
        let results = Results { folder, out: &self.out, world_names: &self.world, quiet: self.quiet };
        results.write(settings, trials.into_iter().map(Ok), &experiment.worlds)?;
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
    pub(super) quiet: bool,
}

impl Results<'_> {
    /// Writes the results of trials, which come in the order of the report, and prints the table.
    pub(super) fn write<W: Displayed>(
        self,
        settings: ReportSettings,
        trials: impl Iterator<Item = anyhow::Result<Trial>>,
        worlds: &[W],
    ) -> Result<(), Failure> {
        let report = collect(settings, self.folder.unfinished(), trials)?;
        let written = report.write(&self.folder, worlds).map_err(anyhow::Error::from)?;
        let inputs: Vec<&Path> = self.world_names.iter().map(Path::new).collect();
        self.folder.finish(&inputs)?;
        if !self.quiet {
            print(report.table())?;
            if report.leaves_out_worlds() {
                print(format_args!("The worlds one by one are in {REPORT}.\n"))?;
            }
            print(format_args!("written to {}: {}", self.out.display(), written.join(", ")))?;
        }
        Ok(())
    }
}

//! Experiments in shards: the option `--shard`, and the subcommands on a folder of shards.

use super::run::{Results, experiment_arguments, report_settings};
use super::{TrialArgs, TrialKind};
use crate::shards::{Header, Shard, ShardFile, Shards};
use anyhow::{Context, anyhow};
use clap::{Parser, Subcommand};
use cli::flags::folder;
use cli::program::{Failure, INTERRUPTED, input, results_folder};
use cli::progress::Progress;
use cli::terminal::{print, say};
use evaluation::trials::Experiment;
use std::io::stderr;
use std::iter::once;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// What can be done with a folder of shards.
#[derive(Clone, Debug, Subcommand)]
pub(super) enum ShardCommand {
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

        /// Print only errors
        #[arg(long, short)]
        quiet: bool,
    },
    /// Print what is finished; also while shards run
    Status {
        /// The folder of the shards
        dir: PathBuf,
    },
}

impl ShardCommand {
    /// Carries out the subcommand.
    pub(super) fn run<K: TrialKind>(&self) -> Result<ExitCode, Failure> {
        match self {
            Self::Missing { dir } => {
                if let Some(missing) = Shards::read(dir).map_err(input)?.missing() {
                    print(missing)?;
                    return Ok(ExitCode::FAILURE);
                }
            }
            Self::Merge { dir, out, quiet } => merge::<K>(dir, out.as_deref().unwrap_or(dir), *quiet)?,
            Self::Status { dir } => print(Shards::read(dir).map_err(input)?.status())?,
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn merge<K: TrialKind>(dir: &Path, out: &Path, quiet: bool) -> Result<(), Failure> {
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
    let folder = results_folder(out).map_err(|(Failure::Run(why) | Failure::Input(why))| input(why))?;
    let results = Results { folder, out, world_names: &args.world, quiet };
    let trials = shards.trials().map_err(input)?.map(|trial| trial.map_err(Into::into));
    results.write(settings, trials, &experiment.worlds)
}

/// The header of the files of the shards of an experiment.
fn header<K: TrialKind>(arguments: Vec<String>, shard: Shard, experiment: &Experiment<K::Spec>) -> Header {
    let trials = experiment.jobs().len() as u64;
    Header::new(K::NAME, env!("CARGO_PKG_VERSION"), arguments, experiment, trials, shard)
}

impl<K: TrialKind> TrialArgs<K> {
    /// Runs the trials of a shard that are not finished yet.
    pub(super) fn run_shard(
        &self,
        shard: Shard,
        experiment: &Experiment<K::Spec>,
        is_canceled: &AtomicBool,
    ) -> Result<ExitCode, Failure> {
        let header = header::<K>(experiment_arguments::<K>(), shard, experiment);
        let file = ShardFile::open(&self.out, &header).map_err(input)?;
        let (all, open) = (shard.trials(header.trials), file.open_trials(experiment));
        let before = all - open.len() as u64;
        if !self.quiet && before > 0 {
            say(stderr(), format_args!("shard {shard}: {before} of {all} trials are finished already"));
        }
        let progress = Progress::of_count(open.len(), "trials", self.quiet);
        let finished = self.pool()?.install(|| file.run(open, is_canceled, || progress.step()));
        drop(progress);
        let finished = before + finished.map_err(anyhow::Error::from)?;
        file.sync().context("start the shard again")?;
        if finished < all {
            let again = "start the shard again to go on";
            let done = format_args!("{finished} of {all} trials of shard {shard} are finished");
            say(stderr(), format_args!("interrupted: {done}; {again}"));
            return Ok(ExitCode::from(INTERRUPTED));
        }
        if !self.quiet {
            print(format_args!("shard {shard} is complete: {all} trials in {}", file.path.display()))?;
        }
        Ok(ExitCode::SUCCESS)
    }
}

//! Experiments in shards: parts that run independently, on any number of machines, and are merged into the report of
//! a single run.
//!
//! Trial k of an experiment belongs to shard k mod n. A shard has one file of lines of JSON: a [`Header`] that names
//! the experiment, then its trials. The file has its name only when it is complete.
//!
//! ```text
//! trials ──▶ ShardFile::write ──▶ shard-1-of-3.jsonl ┐
//!                                 shard-2-of-3.jsonl ├──▶ Shards::read ──▶ trials of the experiment
//!                                 shard-3-of-3.jsonl ┘
//! ```

mod shard;
#[cfg(test)]
mod tests;

pub use shard::{Header, InvalidShard, Shard, array};

use evaluation::trials::{Experiment, Trial, TrialSettings, TrialWorld};
use files::{OutputError, UnfinishedFile, make_folder};
use rayon::prelude::*;
use robot::BUILD;
use std::fmt::Display;
use std::fs::{self, DirEntry};
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

/// The error for files of shards that cannot be written, read or merged.
#[derive(Debug, thiserror::Error)]
pub enum ShardError {
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A file or folder cannot be read, is not the file of this shard, or has shards that cannot be merged: the place, the reason, and
    /// what to do.
    #[error("{0}")]
    Content(String),
}

impl ShardError {
    fn read(path: &Path, why: io::Error) -> Self {
        Self::Content(format!("cannot read {}: {why}", path.display()))
    }

    fn content(path: &Path, why: impl Display) -> Self {
        Self::Content(format!("{}: {why}", path.display()))
    }
}

/// The file of a shard that runs. While it is open, no other process can open it, if the file system has locks.
#[derive(Debug)]
pub struct ShardFile {
    /// The file when it is complete.
    pub path: PathBuf,
    header: Header,
    file: UnfinishedFile,
}

impl ShardFile {
    /// Opens the file of the shard of `header` in a folder, which is made unless it exists; `None` if the shard is complete.
    ///
    /// # Errors
    ///
    /// When the file cannot be written, another process has opened it, or the folder has shards of another experiment:
    /// nothing is changed then.
    pub fn open(folder: &Path, header: &Header) -> Result<Option<Self>, ShardError> {
        make_folder(folder)?;
        let shards = shards_in(folder)?;
        for (shard, path) in &shards {
            if let Some(difference) = read_header(*shard, path)?.difference(header) {
                let why = format!("this shard is {difference}; give another folder by --out");
                return Err(ShardError::content(path, why));
            }
        }
        if shards.iter().any(|(shard, _)| *shard == header.shard) {
            return Ok(None);
        }
        let path = folder.join(header.shard.file_name());
        let file = UnfinishedFile::create(&path)?;
        Ok(Some(Self { path, header: header.clone(), file }))
    }

    /// Writes all trials of the shard, in the order of [`Experiment::jobs`], and gives the file its name.
    ///
    /// # Errors
    ///
    /// When the file cannot be written. Nothing is left of it then.
    pub fn write(self, trials: &[Trial]) -> Result<(), OutputError> {
        self.file.write(|to| {
            serde_json::to_writer(&mut *to, &self.header)?;
            trials.iter().try_for_each(|trial| {
                writeln!(to)?;
                Ok::<_, io::Error>(serde_json::to_writer(&mut *to, trial)?)
            })?;
            writeln!(to)
        })
    }
}

/// The shards of an experiment that have files in a folder.
#[derive(Debug)]
pub struct Shards {
    /// The header of the first one.
    pub header: Header,
    files: Vec<(Shard, PathBuf)>,
    folder: PathBuf,
}

impl Shards {
    /// Finds the files of the shards in a folder.
    ///
    /// # Errors
    ///
    /// When there are none, a file cannot be read or is invalid, or the files are not of one experiment.
    pub fn read(folder: &Path) -> Result<Self, ShardError> {
        let files = shards_in(folder)?;
        let Some((shard, first)) = files.first() else {
            return Err(ShardError::content(folder, "this folder has no complete shard"));
        };
        let header = read_header(*shard, first)?;
        for (shard, path) in &files {
            if let Some(difference) = read_header(*shard, path)?.difference(&header) {
                let why = format!("this shard is {difference} as {}", first.display());
                return Err(ShardError::content(path, why));
            }
        }
        Ok(Self { header, files, folder: folder.to_owned() })
    }

    /// Checks that this program can merge the shards: that they are its own, of its version and of its build, and that all shards
    /// are there.
    ///
    /// # Errors
    ///
    /// When they are not.
    pub fn check(&self, program: &str, version: &str) -> Result<(), ShardError> {
        let shown = self.folder.display();
        let refuse = |why: String| Err(ShardError::Content(format!("{shown} {why}")));
        let Header { program: found, version: found_version, build, shard, .. } = &self.header;
        if found != program {
            return refuse(format!("has shards of {found}: merge them with `{found} merge {shown}`"));
        }
        for (what, found, own) in [("version", found_version, version), ("build", build, BUILD)] {
            if found != own {
                return refuse(format!("has shards of {what} {found}: merge them with that {what}"));
            }
        }
        let mut missing: Vec<u64> = (1..=shard.count()).collect();
        missing.retain(|number| self.files.iter().all(|(shard, _)| shard.number() != *number));
        if missing.is_empty() {
            return Ok(());
        }
        let (missing, count) = (array(&missing), shard.count());
        refuse(format!("is not complete: run --shard I/{count} for I = {missing}, whose files are missing"))
    }

    /// All trials, shard by shard.
    ///
    /// # Errors
    ///
    /// When a file cannot be read, or has other trials than those of its shard of the experiment.
    pub fn trials<W: TrialWorld>(&self, experiment: &Experiment<W>) -> Result<Vec<Trial>, ShardError> {
        let jobs = experiment.jobs();
        let read = |(shard, path): &(Shard, PathBuf)| {
            let own: Vec<_> = jobs.iter().filter(|job| shard.has(job.number)).collect();
            read_trials(path, &own)
        };
        let trials = self.files.par_iter().map(read).collect::<Result<Vec<_>, _>>()?;
        Ok(trials.concat())
    }
}

/// The shards that have files in a folder, in their order.
fn shards_in(folder: &Path) -> Result<Vec<(Shard, PathBuf)>, ShardError> {
    let entries = fs::read_dir(folder).and_then(Iterator::collect::<io::Result<Vec<_>>>);
    let entries = entries.map_err(|why| ShardError::read(folder, why))?;
    let shard =
        |entry: &DirEntry| Some((entry.file_name().to_str().and_then(Shard::of_file_name)?, entry.path()));
    let mut shards: Vec<_> = entries.iter().filter_map(shard).collect();
    shards.sort();
    Ok(shards)
}

/// The lines of a file.
fn lines(path: &Path) -> Result<impl Iterator<Item = Result<String, ShardError>>, ShardError> {
    let failed = |why| ShardError::read(path, why);
    let file = BufReader::with_capacity(1 << 18, files::open(path).map_err(failed)?);
    Ok(file.lines().map(move |line| line.map_err(failed)))
}

/// The first line of the file of a shard.
fn read_header(shard: Shard, path: &Path) -> Result<Header, ShardError> {
    let line = lines(path)?.next().transpose()?.unwrap_or_default();
    let header: Header = serde_json::from_str(&line).map_err(|_| {
        let why = "the first line is not the header of a shard: it was edited, or this is another file";
        ShardError::content(path, why)
    })?;
    if header.shard != shard {
        let why = "this is the file of another shard under a new name; give it its name again";
        return Err(ShardError::content(path, why));
    }
    Ok(header)
}

/// The trials in the file of a shard, which must be those of `jobs` in their order.
fn read_trials<W: TrialWorld>(path: &Path, jobs: &[&TrialSettings<W>]) -> Result<Vec<Trial>, ShardError> {
    let again = "remove the file, and run its shard again";
    let mut trials = Vec::new();
    for (number, line) in (2..).zip(lines(path)?.skip(1)) {
        let is_of = |trial: &Trial| {
            jobs.get(trials.len()).is_some_and(|job| {
                (&*trial.world, &*trial.estimator) == (job.world.name(), job.estimator.name())
                    && (&*trial.strategy, trial.seed) == (job.strategy.name(), job.seed)
            })
        };
        let trial = serde_json::from_str(&line?).ok().filter(is_of);
        trials.push(trial.ok_or_else(|| {
            ShardError::content(path, format!("line {number} is not the trial that belongs there; {again}"))
        })?);
    }
    if trials.len() < jobs.len() {
        let found = trials.len();
        return Err(ShardError::content(path, format!("it has {found} of {} trials; {again}", jobs.len())));
    }
    Ok(trials)
}

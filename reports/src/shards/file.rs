//! The file of a shard that runs.

use super::scan::{Line, MAX_LINE, Scan, not_a_shard, read_line, write_line};
use super::{Header, Shard, ShardError};
use evaluation::trials::{Experiment, Trial, TrialSettings, TrialWorld, run_trial};
use files::{OutputError, lock, make_folder, open_to_append};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::collections::BTreeSet;
use std::fs::{self, DirEntry, File};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// The file of a shard, to which finished trials are appended from any thread. While it is open, no other process can
/// open it, if the file system has locks.
#[derive(Debug)]
pub struct ShardFile {
    /// The file.
    pub path: PathBuf,
    pub(super) shard: Shard,
    key: u64,
    /// The numbers of the trials that were finished when the file was opened.
    pub(super) finished: BTreeSet<u64>,
    file: Mutex<Appended>,
}

#[derive(Debug)]
struct Appended {
    file: File,
    /// The length up to the end of the last whole line, bytes.
    intact: u64,
    /// Why a line could not be written: nothing must follow it.
    failure: Option<io::Error>,
}

impl ShardFile {
    /// Opens the file of the shard of `header` in a folder; folder and file are made unless they exist. A line that
    /// was cut off at the end is removed.
    ///
    /// # Errors
    ///
    /// When the file cannot be written, another process has opened it, or the folder has shards of another experiment:
    /// nothing is changed then.
    pub fn open(folder: &Path, header: &Header) -> Result<Self, ShardError> {
        let shard = header.shard;
        make_folder(folder)?;
        check_others(folder, header)?;
        let path = folder.join(shard.file_name());
        let failed = |why| ShardError::from(OutputError::new(&path, why));
        let mut file = open_to_append(&path).map_err(failed)?;
        lock(&file, &path, "wait for it, or start another shard")?;
        let mut scan = Scan::of(&path, shard, BufReader::new(&file))?;
        let line = write_line(header, 0).map_err(|error| failed(error.into()))?;
        if scan.header.is_none() && !line.as_bytes().starts_with(&scan.torn) {
            return Err(not_a_shard(&path));
        }
        file.set_len(scan.intact).and_then(|()| file.seek(SeekFrom::Start(scan.intact))).map_err(failed)?;
        if scan.header.is_none() {
            file.write_all(line.as_bytes()).map_err(failed)?;
            scan.intact = line.len() as u64;
        }
        Ok(Self {
            shard,
            key: header.key(),
            finished: scan.lines.into_keys().collect(),
            file: Mutex::new(Appended { file, intact: scan.intact, failure: None }),
            path,
        })
    }

    /// Appends a finished trial, which is then in the hands of the operating system: it survives the end of the
    /// program.
    ///
    /// # Errors
    ///
    /// When the line cannot be written, as on a full disk. The lines before it stay; all later calls fail as well.
    pub fn append(&self, number: u64, trial: &Trial) -> Result<(), OutputError> {
        let failed = |why| OutputError::new(&self.path, why);
        let line = Line { job: number, trial };
        let line = write_line(&line, self.key).map_err(|error| failed(error.into()))?;
        let mut appended = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(earlier) = &appended.failure {
            return Err(failed(again(earlier)));
        }
        if let Err(why) = appended.file.write_all(line.as_bytes()) {
            appended.file.set_len(appended.intact).ok(); // a torn line is removed at the next start as well
            appended.failure = Some(again(&why));
            return Err(failed(why));
        }
        appended.intact += line.len() as u64;
        Ok(())
    }

    /// Waits until everything is on the disk: some file systems notice only then that they are full.
    ///
    /// # Errors
    ///
    /// When it cannot be written.
    pub fn sync(&self) -> Result<(), OutputError> {
        let appended = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        appended.file.sync_data().map_err(|why| OutputError::new(&self.path, why))
    }
}

/// The same error once more.
fn again(error: &io::Error) -> io::Error {
    error.raw_os_error().map_or_else(|| error.kind().into(), io::Error::from_raw_os_error)
}

/// The shards that have files in a folder, in their order.
///
/// # Errors
///
/// When the folder cannot be read.
pub(super) fn shards_in(folder: &Path) -> Result<Vec<(Shard, PathBuf)>, ShardError> {
    let entries = fs::read_dir(folder).and_then(Iterator::collect::<io::Result<Vec<_>>>);
    let entries = entries.map_err(|why| ShardError::read(folder, why))?;
    let shard =
        |entry: &DirEntry| Some((entry.file_name().to_str().and_then(Shard::of_file_name)?, entry.path()));
    let mut shards: Vec<_> = entries.iter().filter_map(shard).collect();
    shards.sort();
    Ok(shards)
}

/// Checks that all shards in a folder are of the experiment of `header`, by their first lines, where they are complete.
fn check_others(folder: &Path, header: &Header) -> Result<(), ShardError> {
    for (_, path) in shards_in(folder)? {
        let mut line = Vec::new();
        let file = files::open(&path).map_err(|why| ShardError::read(&path, why))?;
        let read = BufReader::new(file).take(MAX_LINE).read_until(b'\n', &mut line);
        read.map_err(|why| ShardError::read(&path, why))?;
        let text = line.strip_suffix(b"\n").and_then(|line| std::str::from_utf8(line).ok());
        let other = text.and_then(|text| read_line(text, 0));
        if let Some(difference) = other.and_then(|other: Header| other.difference(header)) {
            let why = format!("this shard is {difference}; give another folder by --out");
            return Err(ShardError::content(&path, why));
        }
    }
    Ok(())
}

// The trials of a shard, run and appended to its file.

impl ShardFile {
    /// The trials of the shard that were not finished when the file was opened, in the order in which they are merged.
    pub fn open_trials<'a, W: TrialWorld>(&self, experiment: &'a Experiment<W>) -> Vec<TrialSettings<'a, W>> {
        let mut open = experiment.jobs();
        open.retain(|trial| self.shard.has(trial.number) && !self.finished.contains(&trial.number));
        open.sort_by_key(|trial| trial.number);
        open
    }

    /// Runs trials on the threads of the present rayon pool, and appends them to the file. Returns how many were
    /// finished: all, unless `is_canceled` was set. `observe` is called after each of them, from any thread.
    ///
    /// # Errors
    ///
    /// When a trial cannot run or be written. The other trials are canceled then, and those before are kept.
    pub fn run<W: TrialWorld>(
        &self,
        trials: Vec<TrialSettings<W>>,
        is_canceled: &AtomicBool,
        observe: impl Fn() + Sync,
    ) -> Result<u64, ShardError> {
        let run = |trial| {
            let ran = self.run_one(&trial, is_canceled);
            match ran {
                Ok(true) => observe(),
                Ok(false) => {}
                Err(_) => is_canceled.store(true, Ordering::Relaxed), // the other trials cannot be written either
            }
            ran.map(u64::from)
        };
        trials.into_par_iter().map(run).collect::<Vec<_>>().into_iter().sum()
    }

    /// Runs one trial and appends it to the file; false if it was canceled.
    fn run_one<W: TrialWorld>(
        &self,
        trial: &TrialSettings<W>,
        is_canceled: &AtomicBool,
    ) -> Result<bool, ShardError> {
        let goes_on = || !is_canceled.load(Ordering::Relaxed);
        let Some(done) = goes_on().then(|| run_trial(trial, goes_on)).transpose()?.flatten() else {
            return Ok(false);
        };
        self.append(trial.number, &done).map_err(ShardError::Append)?;
        Ok(true)
    }
}

//! The file of a state, and the thread that writes it.

use super::format::{State, StateError};
use files::{FileLock, OutputError, sync_folder_of, temporary_name, write_file};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The time between two writings: what a run loses at most.
const EVERY: Duration = Duration::from_secs(60);

/// The error for a file that holds no state of this run.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The file cannot be read.
    #[error("cannot read it: {0}")]
    Read(#[from] io::Error),
    /// The file is read, but cannot be used.
    #[error(transparent)]
    State(#[from] StateError),
}

/// A file that is replaced by the present state now and then.
///
/// From [`open`](Self::open) on it is locked: what another run saved between the reading and the writing of this one would
/// be lost. It is written in a thread of its own. A run that is killed leaves the last complete file, and at most an
/// unfinished one and a lock with other names, which the next run uses again.
#[derive(Debug)]
pub struct StateFile {
    /// Its name as given, and the file that it leads to: a link stays one, and all names of a file have one lock.
    path: PathBuf,
    target: PathBuf,
    every: Duration,
    last: Instant,
    writing: Option<JoinHandle<io::Result<()>>>,
    /// Whether the file is kept before it is written.
    keeps: bool,
    _lock: FileLock,
}

impl StateFile {
    /// Locks the file with this name, before it is read, until the value is dropped. Nothing is written yet.
    ///
    /// # Errors
    ///
    /// When another run uses it, when it is no file that can be replaced (a folder, a pipe, a device), when its folder cannot
    /// be written, and when a file beside it, which the run would replace, is of somebody else (`house.state.lock`).
    pub fn open(path: &Path) -> io::Result<Self> {
        let target = target_of(path);
        match fs::metadata(&target) {
            Ok(known) if !known.is_file() => return Err(io::Error::other(NO_FILE)),
            _ => {}
        }
        let (lock, earlier) = (with_ending(&target, "lock"), with_ending(&target, "earlier"));
        let unfinished = [&target, &earlier].map(|path| temporary_name(path));
        [&lock, &earlier].into_iter().chain(&unfinished).try_for_each(|path| check_own(path))?;
        let why = "another run uses it; wait for its end, or give another file by --state";
        let busy = || io::Error::new(io::ErrorKind::ResourceBusy, why);
        let lock = FileLock::new(&lock)?.ok_or_else(busy)?;
        Ok(Self {
            path: path.to_owned(),
            target,
            every: EVERY,
            last: Instant::now(),
            writing: None,
            keeps: false,
            _lock: lock,
        })
    }

    /// The same, written once in this time.
    #[must_use]
    pub fn every(mut self, every: Duration) -> Self {
        self.every = every;
        self
    }

    /// The name of the file, as given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The state in the file; `None` if there is no such file.
    ///
    /// # Errors
    ///
    /// When the file cannot be read, or is not a state.
    pub fn load(&self) -> Result<Option<State>, LoadError> {
        match read_state(&self.target) {
            Err(LoadError::Read(missing)) if missing.kind() == io::ErrorKind::NotFound => Ok(None),
            state => state.map(Some),
        }
    }

    /// Keeps the file beside it before the next [`save`](Self::save), as [`keep_earlier`](Self::keep_earlier).
    pub fn keep_before_save(&mut self) {
        self.keeps = true;
    }

    /// Keeps the file as it is now beside it, with the ending `.earlier`, so that what is saved next can be undone.
    ///
    /// # Errors
    ///
    /// When it cannot be kept.
    pub fn keep_earlier(&self) -> io::Result<()> {
        let mut present = File::open(&self.target)?;
        let kept = write_file(&earlier_name(&self.target), |file| io::copy(&mut present, file).map(|_| ()));
        kept.map_err(|OutputError { why, .. }| why)
    }

    /// Goes back to the file that was [kept](Self::keep_earlier); there is none then.
    ///
    /// # Errors
    ///
    /// When no file was kept.
    pub fn restore_earlier(&self) -> io::Result<()> {
        fs::rename(with_ending(&self.target, "earlier"), &self.target)
    }

    /// Whether it is time to [`save`](Self::save).
    pub fn is_due(&self) -> bool {
        self.last.elapsed() >= self.every && self.writing.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Whether a state is being written now.
    pub fn is_writing(&self) -> bool {
        self.writing.as_ref().is_some_and(|writing| !writing.is_finished())
    }

    /// Begins to write a state. `state` is called in the thread that writes: what takes long belongs there.
    ///
    /// # Errors
    ///
    /// When the writing before has failed. The new one has begun nevertheless.
    pub fn save(&mut self, state: impl FnOnce() -> State + Send + 'static) -> io::Result<()> {
        let before = self.wait();
        let kept = if std::mem::take(&mut self.keeps) { self.keep_earlier() } else { Ok(()) };
        let target = self.target.clone();
        self.last = Instant::now();
        self.writing = Some(std::thread::spawn(move || write(&target, &state())));
        before.and(kept)
    }

    /// Waits until the last state is on the disk.
    ///
    /// # Errors
    ///
    /// When it could not be written. The file is as it was then.
    pub fn wait(&mut self) -> io::Result<()> {
        let Some(writing) = self.writing.take() else { return Ok(()) };
        writing.join().unwrap_or_else(|_| Err(io::Error::other("the thread that writes has ended")))
    }
}

impl Drop for StateFile {
    fn drop(&mut self) {
        self.wait().ok(); // the lock lasts until the last writing has ended
    }
}

/// Why something is no state file.
const NO_FILE: &str = "it is not a file (but a folder, a pipe or a device)";

/// The state in a file, whoever uses it: it is complete at any time.
///
/// # Errors
///
/// When there is none, or it cannot be read.
pub fn read_state(path: &Path) -> Result<State, LoadError> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other(NO_FILE).into()); // a pipe would wait for ever
    }
    let mut file = File::open(path)?;
    // Another kind of file can be very long.
    let mut bytes = vec![0; State::MAGIC.len()];
    match file.read_exact(&mut bytes) {
        Ok(()) if bytes == State::MAGIC => {}
        Err(other) if other.kind() != io::ErrorKind::UnexpectedEof => return Err(other.into()),
        _ => return Err(StateError::OtherKind.into()),
    }
    file.read_to_end(&mut bytes)?;
    Ok(State::from_bytes(&bytes)?)
}

/// The name of the file that [`StateFile::keep_earlier`] keeps: `house.state.earlier` for `house.state`.
pub fn earlier_name(path: &Path) -> PathBuf {
    with_ending(&target_of(path), "earlier")
}

/// The file to which a name leads.
fn target_of(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// Replaces the file at once and completely, or not at all.
fn write(path: &Path, state: &State) -> io::Result<()> {
    let bytes = state.to_bytes().map_err(io::Error::other)?;
    write_file(path, |file| file.write_all(&bytes)).map_err(|OutputError { why, .. }| why)?;
    sync_folder_of(path);
    Ok(())
}

/// Checks that nothing is lost when a run writes this file beside the state: there is none, it is empty, or one of a state.
fn check_own(path: &Path) -> io::Result<()> {
    let mut start = Vec::new();
    let is_own = match path.symlink_metadata() {
        Ok(known) if known.is_file() => {
            File::open(path)?.take(State::MAGIC.len() as u64).read_to_end(&mut start)?;
            State::MAGIC.starts_with(&start)
        }
        known => known.is_err(),
    };
    let why =
        "no run has written it, and this one would replace it; move it, or give another file by --state";
    if is_own { Ok(()) } else { Err(io::Error::other(format!("{}: {why}", path.display()))) }
}

/// The name of a file beside the state: `house.state.lock` while a run uses it.
fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".");
    name.push(ending);
    path.with_file_name(name)
}

#[cfg(test)]
mod tests;

//! The file of a state, and the thread that writes it.

use crate::format::{State, StateError};
use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Write};
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
/// The file is written in a thread of its own. A run that is killed leaves the last complete file, and at most an
/// unfinished one with another name, which the next run replaces.
#[derive(Debug)]
pub struct StateFile {
    path: PathBuf,
    every: Duration,
    last: Instant,
    writing: Option<JoinHandle<io::Result<()>>>,
}

impl StateFile {
    /// The file with this name. Nothing is read or written yet.
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_owned(), every: EVERY, last: Instant::now(), writing: None }
    }

    /// The same, written once in this time.
    #[must_use]
    pub fn every(self, every: Duration) -> Self {
        Self { every, ..self }
    }

    /// The name of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The state in the file; `None` if there is no such file.
    ///
    /// # Errors
    ///
    /// When the file cannot be read, or is not a state.
    pub fn load(&self) -> Result<Option<State>, LoadError> {
        let mut file = match File::open(&self.path) {
            Err(missing) if missing.kind() == io::ErrorKind::NotFound => return Ok(None),
            file => file?,
        };
        // Another kind of file can be a device without an end.
        let mut bytes = vec![0; State::MAGIC.len()];
        match file.read_exact(&mut bytes) {
            Ok(()) if bytes == State::MAGIC => {}
            Err(other) if other.kind() != io::ErrorKind::UnexpectedEof => return Err(other.into()),
            _ => return Err(StateError::OtherKind.into()),
        }
        file.read_to_end(&mut bytes)?;
        Ok(Some(State::from_bytes(&bytes)?))
    }

    /// Checks before a long run that the file can be written. Nothing changes.
    ///
    /// # Errors
    ///
    /// When it cannot, or when another run is writing it.
    pub fn check_writable(&self) -> io::Result<()> {
        let unfinished = unfinished_name(&self.path);
        open_unfinished(&unfinished)?;
        fs::remove_file(unfinished)
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
        let path = self.path.clone();
        self.last = Instant::now();
        self.writing = Some(std::thread::spawn(move || write(&path, &state())));
        before
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

/// Replaces the file at once and completely, or not at all.
fn write(path: &Path, state: &State) -> io::Result<()> {
    let bytes = state.to_bytes().map_err(io::Error::other)?;
    let unfinished = unfinished_name(path);
    let mut file = open_unfinished(&unfinished)?;
    let written = file.set_len(0).and_then(|()| file.write_all(&bytes)).and_then(|()| file.sync_all());
    let renamed = written.and_then(|()| fs::rename(&unfinished, path));
    if renamed.is_err() {
        fs::remove_file(&unfinished).ok(); // the reason for the end is reported
        return renamed;
    }
    sync_folder(path);
    Ok(())
}

fn open_unfinished(unfinished: &Path) -> io::Result<File> {
    // Cut off only when it is locked: it may be the file of a run that goes on.
    let file = File::options().write(true).create(true).truncate(false).open(unfinished)?;
    locked(file.try_lock())?;
    Ok(file)
}

/// Whether the file can be written, after a lock was tried.
fn locked(tried: Result<(), TryLockError>) -> io::Result<()> {
    match tried {
        // Not every file system has locks.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(io::Error::other("another run is writing it")),
    }
}

/// Brings the new name to the disk as well. Not every file system can do it; the file is complete under one of its names.
fn sync_folder(path: &Path) {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    File::open(folder).and_then(|folder| folder.sync_all()).ok();
}

/// The name of the file while it is incomplete: `house.state.unfinished` for `house.state`.
fn unfinished_name(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".unfinished");
    path.with_file_name(name)
}

#[cfg(test)]
mod tests;

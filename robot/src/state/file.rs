//! The file of a state, and the thread that writes it.

use super::format::{Session, State};
use super::settings::{MAX_FILE, StateError};
use files::{FileLock, OutputError, Proof, UnfinishedFile, check_output, replace};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The time between two writings: what a run loses at most.
const EVERY: Duration = Duration::from_secs(60);

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
    writing: Option<JoinHandle<io::Result<bool>>>,
    /// The number of sessions in the file as it was loaded, if all are complete: before another one is added, the file is kept.
    sessions: Option<usize>,
    /// Until the value is dropped; `None` if the file is only read.
    lock: Option<FileLock>,
}

impl StateFile {
    /// Locks the file with this name, before it is read, until the value is dropped. Nothing is written yet.
    ///
    /// # Errors
    ///
    /// When another run uses it, when its folder cannot be written, when it is a link that leads to no file,
    /// and when a file beside it, which the run would replace, is of somebody else (`house.state.lock`).
    pub fn open(path: &Path) -> io::Result<Self> {
        let target = target_of(path)?;
        let other =
            |OutputError { path, why }| io::Error::new(why.kind(), format!("{}: {why}", path.display()));
        check_output(&earlier_of(&target), Some(PROOF)).map_err(other)?;
        let why = "another run uses it; wait for its end, or give another file by --state";
        let busy = || io::Error::new(io::ErrorKind::ResourceBusy, why);
        let lock = FileLock::new(&target.with_added_extension("lock"))?.ok_or_else(busy)?;
        let mut file = Self::to_load(path)?;
        file.lock = Some(lock);
        Ok(file)
    }

    /// The file with this name, to [`load`](Self::load) it: nothing is written, no lock either.
    ///
    /// # Errors
    ///
    /// When it is a link that leads to no file.
    pub fn to_load(path: &Path) -> io::Result<Self> {
        Ok(Self {
            path: path.to_owned(),
            target: target_of(path)?,
            every: EVERY,
            last: Instant::now(),
            writing: None,
            sessions: None,
            lock: None,
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
    pub fn load(&mut self) -> Result<Option<State>, StateError> {
        match read_state(&self.target) {
            Err(StateError::Read(missing)) if missing.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(other) => Err(other),
            Ok(state) => {
                let is_complete =
                    state.sessions.iter().all(|Session { readings: [used, all], .. }| used >= all);
                self.sessions = is_complete.then_some(state.sessions.len());
                Ok(Some(state))
            }
        }
    }

    /// Goes back to the file as it was before the last session was added: it was kept beside this one, with the ending `.earlier`.
    ///
    /// # Errors
    ///
    /// When no file was kept.
    pub fn restore_earlier(&self) -> io::Result<()> {
        replace(&self.target, &earlier_of(&self.target), PROOF).map_err(|OutputError { why, .. }| why)
    }

    /// Whether it is time to [`save`](Self::save).
    pub fn is_due(&self) -> bool {
        self.last.elapsed() >= self.every && self.writing.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Whether a state is being written now.
    pub fn is_writing(&self) -> bool {
        self.writing.as_ref().is_some_and(|writing| !writing.is_finished())
    }

    /// Begins to write a state. `state` is called in the thread that writes: what takes long belongs there. Before the first
    /// session is added to a file that was loaded, the file is kept, for [`restore_earlier`](Self::restore_earlier).
    ///
    /// # Errors
    ///
    /// When the writing before has failed. The new one has begun nevertheless.
    pub fn save(&mut self, state: impl FnOnce() -> State + Send + 'static) -> io::Result<()> {
        let before = self.wait();
        let (target, sessions) = (self.target.clone(), self.sessions);
        self.last = Instant::now();
        self.writing = Some(std::thread::spawn(move || {
            let state = state();
            let is_longer = sessions.is_some_and(|sessions| state.sessions.len() > sessions);
            let kept = if is_longer { keep(&target) } else { Ok(()) };
            write(&target, &state)?;
            kept.map(|()| is_longer)
        }));
        before
    }

    /// Waits until the last state is on the disk.
    ///
    /// # Errors
    ///
    /// When it could not be written. The file is as it was then.
    pub fn wait(&mut self) -> io::Result<()> {
        let Some(writing) = self.writing.take() else { return Ok(()) };
        let ended = |_| Err(io::Error::other("the thread that writes has ended"));
        let is_kept = writing.join().unwrap_or_else(ended)?;
        self.sessions = self.sessions.filter(|_| !is_kept);
        Ok(())
    }
}

impl Drop for StateFile {
    fn drop(&mut self) {
        self.wait().ok(); // the lock lasts until the last writing has ended
        self.lock = None;
    }
}

/// The state in a file, whoever uses it: it is complete at any time.
///
/// # Errors
///
/// When there is none, or it cannot be read.
pub fn read_state(path: &Path) -> Result<State, StateError> {
    let file = files::open(path)?;
    let mut bytes = Vec::new();
    (&file).take(State::MAGIC.len() as u64).read_to_end(&mut bytes)?;
    if !bytes.is_empty() && bytes != State::MAGIC {
        return Err(StateError::OtherKind); // and perhaps very long
    }
    file.take(MAX_FILE).read_to_end(&mut bytes)?;
    State::from_bytes(&files::within(bytes, MAX_FILE)?)
}

/// The name of the file that a [`StateFile`] keeps before a session is added: `house.state.earlier` for `house.state`.
pub fn earlier_name(path: &Path) -> PathBuf {
    earlier_of(&target_of(path).unwrap_or_else(|_| path.to_owned()))
}

fn earlier_of(target: &Path) -> PathBuf {
    target.with_added_extension("earlier")
}

/// The file to which a name leads.
fn target_of(path: &Path) -> io::Result<PathBuf> {
    match path.canonicalize() {
        Err(_) if path.is_symlink() => {
            let to = path.read_link()?;
            Err(io::Error::new(
                io::ErrorKind::NotFound,
                format!(
                    "it is a link to {}, which is not there; make that file's folder available, or remove the link",
                    to.display()
                ),
            ))
        }
        target => Ok(target.unwrap_or_else(|_| path.to_owned())),
    }
}

/// How a state shows that a run wrote it.
const PROOF: Proof = Proof { start: State::MAGIC, is_intact: is_state };

/// Whether a file is a state as it was written: it has its checksum.
fn is_state(mut file: &File) -> bool {
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).is_ok() && State::is_intact(&bytes)
}

/// Copies the file as it is now: what is saved next can be undone.
fn keep(path: &Path) -> io::Result<()> {
    let mut present = File::open(path)?;
    // If somebody has put another file there, that is no state to keep.
    let kept = check_output(path, Some(PROOF))
        .and_then(|()| UnfinishedFile::with_proof(&earlier_of(path), Some(PROOF)))
        .and_then(|file| file.write(|file| io::copy(&mut present, file).map(drop)));
    kept.map_err(|OutputError { why, .. }| why)
}

/// Replaces the file at once and completely, or not at all.
fn write(path: &Path, state: &State) -> io::Result<()> {
    let bytes = state.to_bytes().map_err(io::Error::other)?;
    let written = UnfinishedFile::with_proof(path, Some(PROOF))
        .and_then(|file| file.write(|file| file.write_all(&bytes)));
    written.map_err(|OutputError { why, .. }| why)
}

#[cfg(test)]
mod tests;

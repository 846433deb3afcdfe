//! Locks, which end with the program at the latest.

use super::OutputError;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How often a lock is tried, in steps of 10 ms.
const LOCK_TRIES: u32 = 20;

/// Locks an open file until it is closed. If another run has locked it, `path` cannot be written, and `advice` says
/// what to do.
///
/// # Errors
///
/// When another run has locked the file.
pub fn lock(file: &File, path: &Path, advice: &str) -> Result<(), OutputError> {
    let why = format!("another run is writing there; {advice}");
    let busy = io::Error::new(io::ErrorKind::ResourceBusy, why);
    if is_locked(file) { Ok(()) } else { Err(OutputError::new(path, busy)) }
}

/// Whether this process has the lock of an open file now.
fn is_locked(file: &File) -> bool {
    for _ in 0..LOCK_TRIES {
        match file.try_lock() {
            // A program that is being started holds the locks of the one that starts it for a moment.
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(10)),
            Ok(()) | Err(TryLockError::Error(_)) => return true, // not every file system has locks
        }
    }
    false
}

/// A file that exists while one process has it.
#[derive(Debug)]
pub struct FileLock {
    path: PathBuf,
    file: Option<File>,
}

impl FileLock {
    /// Makes the file, and locks it until the value is dropped; `None` if another process has it.
    ///
    /// # Errors
    ///
    /// When the file cannot be written.
    pub fn new(path: &Path) -> io::Result<Option<Self>> {
        for _ in 0..LOCK_TRIES {
            let file = File::options().write(true).create(true).truncate(false).open(path);
            let file = file.map_err(|why| match why.kind() {
                io::ErrorKind::NotFound => why, // the folder
                kind => io::Error::new(kind, format!("its lock {} cannot be written: {why}", path.display())),
            })?;
            if !is_locked(&file) {
                return Ok(None);
            }
            // Another run can have removed the file after it was opened here.
            if is_file_at(&file, path) {
                return Ok(Some(Self { path: path.to_owned(), file: Some(file) }));
            }
        }
        Ok(None)
    }
}

impl Drop for FileLock {
    fn drop(&mut self) {
        fs::remove_file(&self.path).ok(); // while it is locked: a process that has opened it looks again
        self.file.take();
    }
}

/// Whether an open file still has this name.
#[cfg(unix)]
fn is_file_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |known: fs::Metadata| (known.dev(), known.ino());
    file.metadata().is_ok_and(|open| fs::metadata(path).is_ok_and(|named| id(open) == id(named)))
}

/// An open file cannot be removed on this system.
#[cfg(not(unix))]
fn is_file_at(_file: &File, _path: &Path) -> bool {
    true
}

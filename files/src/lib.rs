//! Files that are either complete or absent, the reader of files, locks, and the folder of the results of a run. It depends on
//! nothing of ours.

mod disk;
mod exchange;
mod folder;
mod read;
mod unfinished;

pub use folder::RunFolder;
pub use read::{open, read, read_text, within};
pub use unfinished::{UnfinishedFile, is_another_kind, temporary_name};

use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The error for a file or folder that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {why}", path.display())]
pub struct OutputError {
    /// The file or folder.
    pub path: PathBuf,
    /// The reason, in most cases an error of the operating system.
    pub why: io::Error,
}

impl OutputError {
    /// The error `why` on `path`.
    pub fn new(path: &Path, why: impl Into<io::Error>) -> Self {
        Self { path: path.to_owned(), why: why.into() }
    }

    /// The error for a file or folder that is not written, since it may hold what no run wrote.
    fn refused(path: &Path, why: String) -> Self {
        Self::new(path, io::Error::new(io::ErrorKind::AlreadyExists, why))
    }

    /// Whether the file or folder was refused: the user has to choose another one.
    pub fn is_refusal(&self) -> bool {
        self.why.kind() == io::ErrorKind::AlreadyExists
    }
}

/// Writes a file as an [`UnfinishedFile`]: an older file stays until the new one is complete.
///
/// # Errors
///
/// When the file cannot be written. Nothing is left of it then.
pub fn write_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), OutputError> {
    UnfinishedFile::create(path)?.write(write)
}

/// Returns when the names in the folder of a file are on the disk. Not every file system can do this; the file is complete under
/// one of its names.
pub fn sync_folder_of(path: &Path) {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    File::open(folder).and_then(|folder| folder.sync_all()).ok();
}

/// Makes a folder, and its parent folders, unless it exists.
///
/// # Errors
///
/// When the folder cannot be made.
pub fn make_folder(path: &Path) -> Result<(), OutputError> {
    fs::create_dir_all(path).map_err(|why| OutputError::new(path, why))
}

// Locks, which end with the program at the latest.

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

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_is_replaced_by_a_whole_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        for text in ["one", "two"] {
            write_file(&path, |file| file.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_failure_half_way_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").unwrap();
        let error = write_file(&path, |file| {
            file.write_all(&[b'x'; 100_000])?;
            Err(io::ErrorKind::StorageFull.into())
        });
        assert_eq!(
            error.unwrap_err().to_string(),
            format!("cannot write {}: no storage space", path.display())
        );
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let path = Path::new("no/such/folder/a.txt");
        let error = write_file(path, |_| Ok(())).unwrap_err().to_string();
        assert!(error.starts_with("cannot write no/such/folder/a.txt: "), "{error}");
    }
}

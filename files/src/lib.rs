//! Files that are either complete or absent, the reader of files, locks, and the folder of the results of a run. It depends on
//! nothing of ours.

mod disk;
mod exchange;
mod folder;
mod marker;
mod read;
mod unfinished;

pub use folder::{RunFolder, is_below};
pub use read::{open, read, read_text, within};
pub use unfinished::{Proof, UnfinishedFile, check_output, replace};

use disk::Folder;
use std::ffi::OsString;
use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Write};
use std::os::unix::fs::MetadataExt;
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

/// Why a file beside a state, or the state, is not replaced.
const FOREIGN: &str = "no run has written it, or it was changed since, and this one would replace it; move it, or give another file \
                       by --state";
/// The content of a lock: a file with another one is none.
const LOCK: &[u8] = b"A run of curious uses the file beside this one.\n";

/// A file that exists while one process has it.
#[derive(Debug)]
pub struct FileLock {
    folder: Folder,
    name: OsString,
    file: File,
}

impl FileLock {
    /// Makes the file, and locks it until the value is dropped; `None` if another process has it.
    ///
    /// # Errors
    ///
    /// When the file cannot be written, or is not a lock.
    pub fn new(path: &Path) -> io::Result<Option<Self>> {
        let (folder, name) = Folder::of(path)?;
        let failed = |why: io::Error| {
            let text = format!("its lock {} cannot be written: {why}", path.display());
            io::Error::new(why.kind(), text)
        };
        for _ in 0..LOCK_TRIES {
            let mut file = match folder.file_to_write(&name) {
                Err(why) if why.kind() == io::ErrorKind::AlreadyExists => continue, // of another run, just now
                file => file.map_err(failed)?,
            };
            if !is_locked(&file) {
                return Ok(None);
            }
            // Another run can have removed the file after it was opened here.
            if folder.file(&name)?.is_none_or(|named| !is_same(&file, &named)) {
                continue;
            }
            let mut content = Vec::new();
            (&file).take(1 + LOCK.len() as u64).read_to_end(&mut content)?;
            if content.is_empty() {
                file.write_all(LOCK).map_err(failed)?;
            } else if content != LOCK {
                return Err(io::Error::other(format!("{}: {FOREIGN}", path.display())));
            }
            return Ok(Some(Self { folder, name, file }));
        }
        Ok(None)
    }
}

impl Drop for FileLock {
    fn drop(&mut self) {
        // While it is locked: a process that has opened it looks again.
        if self
            .folder
            .file(&self.name)
            .is_ok_and(|named| named.is_some_and(|named| is_same(&self.file, &named)))
        {
            self.folder.remove(&self.name).ok();
        }
    }
}

/// Whether two open files are one.
fn is_same(a: &File, b: &File) -> bool {
    let id = |file: &File| file.metadata().map(|known| (known.dev(), known.ino()));
    id(a).is_ok_and(|a| id(b).is_ok_and(|b| a == b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<_> = names.map(|name| name.into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_replaced_by_a_whole_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        for text in ["one", "two"] {
            write_file(&path, |file| file.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(names(folder.path()), [marker::FILES, "a.txt"]);
    }

    #[test]
    fn a_failure_half_way_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_file(&path, |file| file.write_all(b"old")).unwrap();
        let error = write_file(&path, |file| {
            file.write_all(&[b'x'; 100_000])?;
            Err(io::ErrorKind::StorageFull.into())
        });
        assert_eq!(
            error.unwrap_err().to_string(),
            format!("cannot write {}: no storage space", path.display())
        );
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(folder.path()), [marker::FILES, "a.txt"]);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let path = Path::new("no/such/folder/a.txt");
        let error = write_file(path, |_| Ok(())).unwrap_err().to_string();
        assert!(error.starts_with("cannot write no/such/folder/a.txt: "), "{error}");
    }
}

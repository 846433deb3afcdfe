//! Files that are either complete or absent, locks, and the folder of the results of a run. It depends on nothing of ours.

mod disk;
mod exchange;
mod folder;
mod lock;
mod marker;
mod unfinished;

pub use folder::RunFolder;
pub use lock::{FileLock, lock};
pub use unfinished::{UnfinishedFile, is_another_kind, temporary_name};

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

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

//! The operations on files of which an exchange of results consists. In tests, each of them can fail.

use super::{OutputError, UnfinishedFile};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

/// Gives a file another name.
pub(super) fn rename(from: &Path, to: &Path) -> Result<(), OutputError> {
    run(to, || fs::rename(from, to))
}

/// Makes a folder, unless it exists.
pub(super) fn make_folder(path: &Path) -> Result<(), OutputError> {
    run(path, || fs::create_dir_all(path))
}

/// Writes a file that is either complete or as it was.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    run(path, || {
        let file = UnfinishedFile::create(path).map_err(|error| error.why)?;
        file.file().write_all(bytes)?;
        file.finish().map_err(|error| error.why)
    })
}

/// Removes a file, if it exists.
pub(super) fn remove(path: &Path) -> Result<(), OutputError> {
    run(path, || unless_missing(fs::remove_file(path)))
}

/// Removes a folder with everything in it, if it exists.
pub(super) fn remove_folder(path: &Path) -> Result<(), OutputError> {
    run(path, || unless_missing(fs::remove_dir_all(path)))
}

/// Removes the files in a folder, and the folder, in which the file `last` goes last. A folder in it is not of a run: it
/// stays, and with it `last`.
pub(super) fn remove_run(folder: &Path, last: &str) -> Result<(), OutputError> {
    run(folder, || {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            if !entry.file_type()?.is_dir() && entry.file_name() != last {
                fs::remove_file(entry.path())?;
            }
        }
        if fs::read_dir(folder)?.count() > 1 { Ok(()) } else { fs::remove_dir_all(folder) }
    })
}

/// The content of a file; `None` if there is none. Links and what is not a file are errors: a pipe would wait for ever.
pub(super) fn read(path: &Path) -> io::Result<Option<Vec<u8>>> {
    match path.symlink_metadata() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
        Ok(known) if known.is_file() => fs::read(path).map(Some),
        Ok(_) => Err(io::Error::other("it is not a regular file")),
    }
}

/// Returns when a file or folder is on the disk.
pub(super) fn sync(path: &Path) -> Result<(), OutputError> {
    // Not every file system can do this for folders.
    run(path, || {
        File::open(path)?.sync_all().or_else(|error| if path.is_dir() { Ok(()) } else { Err(error) })
    })
}

fn unless_missing(done: io::Result<()>) -> io::Result<()> {
    done.or_else(|error| if error.kind() == io::ErrorKind::NotFound { Ok(()) } else { Err(error) })
}

fn run(path: &Path, operation: impl FnOnce() -> io::Result<()>) -> Result<(), OutputError> {
    #[cfg(test)]
    faults::next().map_err(|why| OutputError::new(path, why))?;
    operation().map_err(|why| OutputError::new(path, why))
}

/// Makes operations of this thread fail.
#[cfg(test)]
pub(super) mod faults {
    use std::cell::Cell;
    use std::io;

    thread_local! {
        /// The number of operations that succeed before one fails, and whether all later ones fail as well, as they do
        /// after the end of the program.
        static FAULT: Cell<Option<(usize, bool)>> = const { Cell::new(None) };
    }

    pub(in super::super) fn set(fault: Option<(usize, bool)>) {
        FAULT.set(fault);
    }

    /// Whether the fault is still to come.
    pub(in super::super) fn is_pending() -> bool {
        matches!(FAULT.get(), Some((count, _)) if count > 0)
    }

    pub(super) fn next() -> io::Result<()> {
        match FAULT.get() {
            None => Ok(()),
            Some((0, ends)) => {
                FAULT.set(ends.then_some((0, true)));
                Err(io::Error::other("injected"))
            }
            Some((count, ends)) => {
                FAULT.set(Some((count - 1, ends)));
                Ok(())
            }
        }
    }
}

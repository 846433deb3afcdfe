//! A file that has its name only when it is complete.

use super::{OutputError, lock};
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

/// The maximum time until somebody reads from a pipe.
const READER_TIMEOUT: Duration = Duration::from_secs(5);

/// A file that is being written under a temporary name in the same folder: `run.unfinished.rrd` for `run.rrd`. A file
/// that is dropped before it is finished is removed; a killed run leaves it, and the next one replaces it.
///
/// A device or a pipe is written directly.
#[derive(Debug)]
pub struct UnfinishedFile {
    path: PathBuf,
    /// The temporary name; `None` for a device or a pipe, and when the file is finished.
    partial: Option<PathBuf>,
    file: File,
}

impl UnfinishedFile {
    /// Creates the file. An older file with the final name stays until [`UnfinishedFile::finish`].
    ///
    /// # Errors
    ///
    /// When the file cannot be written, or when another run is writing it.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        let failed = |why: io::Error| OutputError::new(path, why);
        match fs::metadata(path) {
            Ok(known) if known.is_dir() => return Err(failed(io::ErrorKind::IsADirectory.into())),
            Ok(known) if !known.is_file() => {
                let file = open_device(path).map_err(failed)?;
                return Ok(Self { path: path.to_owned(), partial: None, file });
            }
            _ => {}
        }
        let partial = temporary_name(path);
        // Cut off only when it is locked: it may be the file of a run that goes on.
        let file = File::options().write(true).create(true).truncate(false).open(&partial).map_err(failed)?;
        lock(&file, path, "wait for it, or give another name")?;
        file.set_len(0).map_err(failed)?;
        Ok(Self { path: path.to_owned(), partial: Some(partial), file })
    }

    /// The open file, to write to.
    pub fn file(&self) -> &File {
        &self.file
    }

    /// Writes the whole file, through a buffer, and gives it its name.
    ///
    /// # Errors
    ///
    /// When the file cannot be written. Nothing is left of it then.
    pub fn write(self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), OutputError> {
        let mut to = BufWriter::new(&self.file);
        let written = write(&mut to).and_then(|()| to.flush());
        drop(to);
        written.map_err(|why| OutputError::new(&self.path, why))?;
        self.finish()
    }

    /// Gives the complete file its name when its content is on the disk. An older file is replaced.
    ///
    /// # Errors
    ///
    /// When the file cannot be brought to the disk, or cannot be renamed.
    pub fn finish(mut self) -> Result<(), OutputError> {
        let Some(partial) = &self.partial else { return Ok(()) };
        let renamed = self.file.sync_all().and_then(|()| fs::rename(partial, &self.path));
        renamed.map_err(|why| OutputError::new(&self.path, why))?;
        self.partial = None;
        Ok(())
    }
}

impl Drop for UnfinishedFile {
    fn drop(&mut self) {
        if let Some(partial) = &self.partial {
            fs::remove_file(partial).ok(); // the reason for the end is reported
        }
    }
}

/// Opens a device or a pipe to write to. Opening a pipe takes until somebody reads from it.
fn open_device(path: &Path) -> io::Result<File> {
    let (report, opened) = channel();
    let path = path.to_owned();
    thread::spawn(move || report.send(File::options().write(true).open(path)));
    let nobody = || io::Error::new(io::ErrorKind::TimedOut, "this is a pipe, and nobody reads from it");
    opened.recv_timeout(READER_TIMEOUT).unwrap_or_else(|_| Err(nobody()))
}

/// Whether there is a file that is neither empty nor begins with `start`: another kind of file, which must not be
/// replaced.
pub fn is_another_kind(path: &Path, start: &[u8]) -> bool {
    let is_file = path.metadata().is_ok_and(|known| known.is_file() && known.len() > 0);
    let mut found = vec![0; start.len()];
    is_file && !File::open(path).is_ok_and(|mut file| file.read_exact(&mut found).is_ok() && found == start)
}

/// The name of a file while it is incomplete. It keeps its ending, so that a viewer opens it.
pub fn temporary_name(path: &Path) -> PathBuf {
    path.with_extension("unfinished").with_added_extension(path.extension().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_appears_when_it_is_complete() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").unwrap();
        fs::write(folder.path().join("a.unfinished.txt"), "of a killed run").unwrap();
        let file = UnfinishedFile::create(&path).unwrap();
        file.file().write_all(b"new").unwrap();
        let busy = UnfinishedFile::create(&path).unwrap_err().to_string();
        assert!(busy.ends_with("another run is writing there; wait for it, or give another name"), "{busy}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        file.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        drop(UnfinishedFile::create(&path).unwrap());
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_device_is_written_directly() {
        let file = UnfinishedFile::create(Path::new("/dev/null")).unwrap();
        file.file().write_all(b"new").unwrap();
        file.finish().unwrap();
        assert!(fs::metadata("/dev/null").unwrap().len() == 0);
    }
}

//! A file that has its name only when it is complete.

use super::disk::Folder;
use super::marker::{check_file, is_of_a_run, record};
use super::{FOREIGN, OutputError, is_locked};
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Seek, Write};
use std::os::unix::fs::FileTypeExt;
use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

/// The maximum time until somebody reads from a pipe.
const READER_TIMEOUT: Duration = Duration::from_secs(5);
/// The number of incomplete files that killed runs can leave of one file: they are all that is left of a recording.
const MAX_LEFT: u32 = 999;

/// A kind of file whose content shows that a run wrote it.
#[derive(Clone, Copy, Debug)]
pub struct Proof {
    /// How such a file begins: of an incomplete one, nothing else is known.
    pub start: &'static [u8],
    /// Whether a file is complete, and was not changed.
    pub is_intact: fn(&File) -> bool,
}

/// A file that is being written under a temporary name in the same folder: `run.unfinished.rrd` for
/// `run.rrd`. A file that is dropped before it is finished is removed; a killed run leaves it, and the next
/// one takes another name: `run.unfinished_2.rrd`.
///
/// Every file that a program writes is opened here, and one rule holds for all: a file that exists is
/// replaced only if a marker in its folder has its hash, or if its content has one. Everything else is
/// refused, and stays.
///
/// A device or a pipe is written directly.
#[derive(Debug)]
pub struct UnfinishedFile {
    path: PathBuf,
    /// `None` for a device or a pipe, and when the file is finished or kept.
    target: Option<Target>,
    file: File,
}

#[derive(Debug)]
struct Target {
    folder: Folder,
    name: OsString,
    /// The temporary name.
    partial: OsString,
    /// How a file with the final name proves that it may be replaced; `None`: by a marker.
    proof: Option<Proof>,
}

impl UnfinishedFile {
    /// Creates the file. An older file with the final name stays until [`UnfinishedFile::finish`].
    ///
    /// # Errors
    ///
    /// When the file cannot be written, when another run is writing it, or when it would replace a file that
    /// no run wrote ([`OutputError::is_refusal`]).
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        Self::with_proof(path, None)
    }

    /// The same, with a proof for a kind of file whose content shows that a run wrote it.
    ///
    /// # Errors
    ///
    /// As [`UnfinishedFile::create`].
    pub fn with_proof(path: &Path, proof: Option<Proof>) -> Result<Self, OutputError> {
        let failed = |why: io::Error| OutputError::new(path, why);
        match fs::metadata(path) {
            Ok(known) if known.is_dir() => return Err(failed(io::ErrorKind::IsADirectory.into())),
            Ok(known) if known.file_type().is_char_device() || known.file_type().is_fifo() => {
                let file = open_device(path).map_err(failed)?;
                return Ok(Self { path: path.to_owned(), target: None, file });
            }
            _ => {}
        }
        let (folder, name) = Folder::of(path).map_err(failed)?;
        check(&folder, &name, proof)?;
        let (file, partial) = partial(&folder, &name, proof)?;
        let target = Target { folder, name, partial, proof };
        Ok(Self { path: path.to_owned(), target: Some(target), file })
    }

    /// The name of the file, as given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The path under which it is written.
    pub fn unfinished(&self) -> PathBuf {
        self.target.as_ref().map_or(self.path.clone(), |target| target.folder.join(&target.partial))
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

    /// Gives the complete file its name when its content is on the disk. An older file of a run is replaced.
    ///
    /// # Errors
    ///
    /// When the file cannot be brought to the disk, or cannot be renamed. If somebody has given its name to
    /// another file, the new one stays under its temporary name.
    pub fn finish(mut self) -> Result<(), OutputError> {
        let Some(Target { folder, name, partial, proof }) = &self.target else { return Ok(()) };
        let failed = |why| OutputError::new(&self.path, why);
        self.file.sync_all().map_err(failed)?;
        if let Err(error) = check(folder, name, *proof) {
            let why = format!("{}; the new one is {}", error.why, folder.join(partial).display());
            self.target = None;
            return Err(OutputError::refused(&error.path, why));
        }
        if !folder.has_file(partial) {
            return Err(failed(io::Error::other("it was removed while it was written")));
        }
        match folder.is_free(name) {
            true => folder.rename(partial, folder, name)?,
            false => folder.replace(name, partial)?,
        }
        let listed = name.to_str().filter(|_| proof.is_none());
        let recorded = listed.map_or(Ok(()), |name| record(folder, name));
        folder.sync();
        self.target = None;
        recorded
    }
}

impl Write for UnfinishedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for UnfinishedFile {
    fn drop(&mut self) {
        if let Some(Target { folder, partial, .. }) = &self.target {
            folder.remove(partial).ok(); // the reason for the end is reported
        }
    }
}

/// Checks that a run may write this file, with its proof if it has one, before any work on it.
///
/// # Errors
///
/// As [`UnfinishedFile::create`].
pub fn check_output(path: &Path, proof: Option<Proof>) -> Result<(), OutputError> {
    match Folder::of(path) {
        Err(why) if why.kind() == io::ErrorKind::NotFound => Ok(()), // the folder is still to be made
        Err(why) => Err(OutputError::new(path, why)),
        Ok((folder, name)) => check(&folder, &name, proof),
    }
}

/// Gives a file with a proof the name of another one with a proof, in the same folder.
///
/// # Errors
///
/// When there is no such file, or when one of them has no proof.
pub fn replace(file: &Path, by: &Path, proof: Proof) -> Result<(), OutputError> {
    let (folder, name) = Folder::of(file).map_err(|why| OutputError::new(file, why))?;
    let by = by.file_name().unwrap_or_default();
    if folder.is_free(by) {
        return Err(OutputError::new(&folder.join(by), io::ErrorKind::NotFound));
    }
    [&name, by].into_iter().try_for_each(|name| check(&folder, name, Some(proof)))?;
    folder.replace(&name, by)
}

fn check(folder: &Folder, name: &OsStr, proof: Option<Proof>) -> Result<(), OutputError> {
    let Some(proof) = proof else { return check_file(folder, name) };
    if is_of_a_run(folder) {
        let why = "a run writes its results in this folder, or has left it; choose another one";
        return Err(OutputError::refused(&folder.path, why.into()));
    }
    if folder.is_free(name)
        || folder.file(name).is_ok_and(|file| file.is_some_and(|file| (proof.is_intact)(&file)))
    {
        return Ok(());
    }
    Err(OutputError::refused(&folder.join(name), FOREIGN.into()))
}

/// Creates the file with the first temporary name that is free. What a killed run has left of a file with a
/// proof is removed, unless it is complete: then somebody has given it this name. An empty one is used again.
fn partial(folder: &Folder, name: &OsStr, proof: Option<Proof>) -> Result<(File, OsString), OutputError> {
    let path = folder.join(name);
    for partial in (1..=MAX_LEFT).map(|number| temporary_name(Path::new(name), number)) {
        if let Some(left) = folder.file(&partial).ok().flatten() {
            if !is_locked(&left) {
                let why = "another run is writing there; wait for it, or give another name";
                return Err(OutputError::new(&path, io::Error::new(io::ErrorKind::ResourceBusy, why)));
            }
            let mut start = Vec::new();
            let is_left = |proof: Proof| {
                let is_read = (&left).take(proof.start.len() as u64).read_to_end(&mut start).is_ok();
                let is_part = is_read && start == proof.start && (&left).rewind().is_ok();
                is_part && !(proof.is_intact)(&left)
            };
            if left.metadata().is_ok_and(|known| known.len() == 0) || proof.is_some_and(is_left) {
                folder.remove(&partial)?;
            }
        }
        match folder.create(&partial) {
            Err(why) if why.kind() == io::ErrorKind::AlreadyExists => {}
            created => {
                let file = created.map_err(|why| OutputError::new(&path, why))?;
                is_locked(&file); // nobody else has opened it
                return Ok((file, partial.into_os_string()));
            }
        }
    }
    let last = temporary_name(&path, MAX_LEFT);
    let why = format!("runs that were killed have left {} and others; move or remove them", last.display());
    Err(OutputError::refused(&path, why))
}

/// Opens a device or a pipe to write to. Opening a pipe takes until somebody reads from it.
fn open_device(path: &Path) -> io::Result<File> {
    let (report, opened) = channel();
    let path = path.to_owned();
    thread::spawn(move || report.send(File::options().write(true).open(path)));
    let nobody = || io::Error::new(io::ErrorKind::TimedOut, "this is a pipe, and nobody reads from it");
    opened.recv_timeout(READER_TIMEOUT).unwrap_or_else(|_| Err(nobody()))
}

/// Whether this is the name of a file while it is incomplete.
pub(super) fn is_temporary(name: &OsStr) -> bool {
    let is_one = |part: &OsStr| part.to_string_lossy().starts_with("unfinished");
    let (name, stem) = (Path::new(name), name.to_str().map(Path::new).and_then(Path::file_stem));
    name.extension().is_some_and(is_one)
        || stem.and_then(|stem| Path::new(stem).extension()).is_some_and(is_one)
}

/// The name of a file while it is incomplete. It keeps its ending, so that a viewer opens it.
fn temporary_name(path: &Path, number: u32) -> PathBuf {
    let number = if number == 1 { String::new() } else { format!("_{number}") };
    path.with_extension(format!("unfinished{number}"))
        .with_added_extension(path.extension().unwrap_or_default())
}

#[cfg(test)]
mod tests;

//! Folders by open handles, and the operations on files in them. In tests, each operation that changes
//! something can fail.
//!
//! A folder can come from a stranger. A name in it is therefore always looked up in the open folder and never
//! followed if it is a link: whatever is read, made, moved or removed is inside.

use super::OutputError;
use rustix::fs::{AtFlags, Dir, FileType, Mode, OFlags, RenameFlags, Stat};
use rustix::io::Errno;
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStringExt;
use std::path::{Path, PathBuf};

/// What is read of a file of ours that lists names; a longer one is none of ours.
const MAX_BYTES: u64 = 1 << 26;
const FLAGS: OFlags = OFlags::CLOEXEC.union(OFlags::NOFOLLOW);

/// An open folder.
#[derive(Debug)]
pub(super) struct Folder {
    /// Its name in messages.
    pub(super) path: PathBuf,
    handle: OwnedFd,
}

impl Folder {
    /// Opens the folder with a path that the user has given. Links in the path are followed.
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let from = if path == "" { Path::new(".") } else { path };
        let handle = rustix::fs::open(from, OFlags::DIRECTORY | OFlags::CLOEXEC, Mode::empty())?;
        Ok(Self { path: path.to_owned(), handle })
    }

    /// The folder of a file, and the name of the file in it.
    pub(super) fn of(file: &Path) -> io::Result<(Self, OsString)> {
        let name = file.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
        Ok((Self::open(file.parent().unwrap_or(Path::new("")))?, name.to_owned()))
    }

    /// The path of a file in the folder, for messages.
    pub(super) fn join(&self, name: impl AsRef<Path>) -> PathBuf {
        self.path.join(name)
    }

    /// A folder in this one; a link is none.
    pub(super) fn inner(&self, name: &str) -> io::Result<Self> {
        let handle = rustix::fs::openat(&self.handle, name, FLAGS | OFlags::DIRECTORY, Mode::empty())?;
        Ok(Self { path: self.join(name), handle })
    }

    /// The same, made unless it exists. What has its name and is no folder is refused.
    pub(super) fn make_inner(&self, name: &str) -> Result<Self, OutputError> {
        self.run(name, || unless(Errno::EXIST, rustix::fs::mkdirat(&self.handle, name, Mode::from(0o777))))?;
        self.inner(name).map_err(|_| {
            let why = "it is a link or a file; move it, or give another folder by --out";
            OutputError::refused(&self.join(name), why.into())
        })
    }

    /// What has a name in the folder; `None` if nothing has.
    pub(super) fn find(&self, name: impl AsRef<Path>) -> io::Result<Option<Stat>> {
        match rustix::fs::statat(&self.handle, name.as_ref(), AtFlags::SYMLINK_NOFOLLOW) {
            Err(Errno::NOENT) => Ok(None),
            found => Ok(Some(found?)),
        }
    }

    /// Whether nothing has this name in the folder, as far as can be known.
    pub(super) fn is_free(&self, name: impl AsRef<Path>) -> bool {
        matches!(self.find(name), Ok(None))
    }

    /// Whether a regular file has this name in the folder.
    pub(super) fn has_file(&self, name: impl AsRef<Path>) -> bool {
        self.find(name).is_ok_and(|found| found.is_some_and(|found| kind(&found).is_file()))
    }

    /// Opens a regular file; `None` if there is none. Links and what is not a file are errors: a pipe would
    /// wait for ever.
    pub(super) fn file(&self, name: impl AsRef<Path>) -> io::Result<Option<File>> {
        self.open_file(name.as_ref(), OFlags::RDONLY)
    }

    /// Opens a regular file to read and to write; it is made unless it exists.
    pub(super) fn file_to_write(&self, name: impl AsRef<Path>) -> io::Result<File> {
        let name = name.as_ref();
        self.open_file(name, OFlags::RDWR)?.map_or_else(|| self.create(name), Ok)
    }

    fn open_file(&self, name: &Path, access: OFlags) -> io::Result<Option<File>> {
        let flags = access | FLAGS | OFlags::NONBLOCK;
        match self.find(name)? {
            None => Ok(None),
            Some(found) if kind(&found).is_file() => {
                Ok(Some(rustix::fs::openat(&self.handle, name, flags, Mode::empty())?.into()))
            }
            Some(_) => Err(io::Error::other("it is not a regular file")),
        }
    }

    /// The content of a regular file that lists names; `None` if there is none.
    pub(super) fn read(&self, name: &str) -> io::Result<Option<Vec<u8>>> {
        let Some(file) = self.file(name)? else { return Ok(None) };
        let mut bytes = Vec::new();
        file.take(MAX_BYTES).read_to_end(&mut bytes)?;
        Ok(Some(bytes))
    }

    /// Makes a file with a name that nothing has.
    pub(super) fn create(&self, name: impl AsRef<Path>) -> io::Result<File> {
        let flags = OFlags::RDWR | OFlags::CREATE | OFlags::EXCL | FLAGS;
        Ok(rustix::fs::openat(&self.handle, name.as_ref(), flags, Mode::from(0o666))?.into())
    }

    /// Writes a file that lists names: it is either complete or as it was.
    pub(super) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        self.run(name, || {
            let mut free = (1..1000).map(|number| format!("{name}_{number}"));
            let new = free.find(|new| self.is_free(new)).unwrap_or_default();
            let mut file = self.create(&new)?;
            file.write_all(bytes).and_then(|()| file.sync_all())?;
            Ok(rustix::fs::renameat(&self.handle, new.as_str(), &self.handle, name)?)
        })
    }

    /// Gives a file a name that nothing has, here or in another folder.
    pub(super) fn rename(
        &self,
        name: impl AsRef<Path>,
        to: &Self,
        new: impl AsRef<Path>,
    ) -> Result<(), OutputError> {
        let (name, new) = (name.as_ref(), new.as_ref());
        to.run(new, || {
            match rustix::fs::renameat_with(&self.handle, name, &to.handle, new, RenameFlags::NOREPLACE) {
                // Not every file system can do this.
                Err(Errno::INVAL | Errno::NOSYS) if to.is_free(new) => {
                    Ok(rustix::fs::renameat(&self.handle, name, &to.handle, new)?)
                }
                done => Ok(done?),
            }
        })
    }

    /// Puts the file `by` in the place of the file `name`, which is lost.
    pub(super) fn replace(&self, name: impl AsRef<Path>, by: impl AsRef<Path>) -> Result<(), OutputError> {
        let (name, by) = (name.as_ref(), by.as_ref());
        self.run(name, || Ok(rustix::fs::renameat(&self.handle, by, &self.handle, name)?))
    }

    /// Removes a file or a link, if it exists.
    pub(super) fn remove(&self, name: impl AsRef<Path>) -> Result<(), OutputError> {
        let name = name.as_ref();
        self.run(name, || unless(Errno::NOENT, rustix::fs::unlinkat(&self.handle, name, AtFlags::empty())))
    }

    /// Removes a folder in this one. A folder with something in it stays.
    pub(super) fn remove_inner(&self, name: &str) -> Result<(), OutputError> {
        self.run(name, || {
            unless(Errno::NOTEMPTY, rustix::fs::unlinkat(&self.handle, name, AtFlags::REMOVEDIR))
        })
    }

    /// All names in the folder, sorted.
    pub(super) fn names(&self) -> io::Result<Vec<OsString>> {
        let mut names = Vec::new();
        for entry in Dir::read_from(&self.handle)? {
            names.push(OsString::from_vec(entry?.file_name().to_bytes().to_vec()));
        }
        names.retain(|name| name != "." && name != "..");
        names.sort();
        Ok(names)
    }

    /// Returns when the names in the folder are on the disk. Not every file system can do this.
    pub(super) fn sync(&self) {
        rustix::fs::fsync(&self.handle).ok();
    }

    /// Whether a path still leads to this folder.
    pub(super) fn is_at(&self, path: &Path) -> bool {
        let id = |folder: &Self| rustix::fs::fstat(&folder.handle).map(|known| (known.st_dev, known.st_ino));
        Self::open(path).is_ok_and(|other| id(&other).is_ok_and(|there| Ok(there) == id(self)))
    }

    /// The folder as a file, to lock it.
    pub(super) fn to_lock(&self) -> io::Result<File> {
        Ok(self.handle.try_clone()?.into())
    }

    fn run(
        &self,
        name: impl AsRef<Path>,
        operation: impl FnOnce() -> io::Result<()>,
    ) -> Result<(), OutputError> {
        let failed = |why| OutputError::new(&self.join(name), why);
        #[cfg(test)]
        let operation = || faults::next().and_then(|()| operation());
        operation().map_err(failed)
    }
}

pub(super) fn kind(found: &Stat) -> FileType {
    FileType::from_raw_mode(found.st_mode)
}

fn unless(harmless: Errno, done: rustix::io::Result<()>) -> io::Result<()> {
    Ok(done.or_else(|error| if error == harmless { Ok(()) } else { Err(error) })?)
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

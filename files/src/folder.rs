//! The folder of a run's results.

use super::disk::Folder;
use super::exchange::{Exchange, Moves};
use super::marker::{self, LOCK, LOCK_CONTENT, Marker, RESULTS, UNFINISHED};
use super::unfinished::is_temporary;
use super::{OutputError, lock, make_folder};
use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The number of folders that killed runs can leave: the oldest goes, unless somebody has put something into it.
const MAX_LEFT: u32 = 9;
/// Results of the programs whose names do not depend on the world: a folder that has other files with these names is
/// refused before the run. Other names are checked at the end.
const NAMES: &str = "\
    map_log.rrd summary.json report.json report.html trials.csv map.pgm map.yaml \
    permanent.pgm permanent.yaml speed_mask.pgm speed_mask.yaml keepout_mask.pgm keepout_mask.yaml \
    cell_statistics.csv things.json trajectory.tum trajectory_true.tum \
    trajectory.png figure3.png figure3.svg curves.png curves.svg figure5.png occupancy.png \
    interval.png change_probability.png recency.png predicted.png";

/// The folder of the results of one run.
///
/// A run writes into the subfolder `unfinished_run`, [`RunFolder::unfinished`]. At the end the results of the earlier
/// run are replaced by the new ones, the summary last; whatever fails before, the earlier results stay. The file
/// `.curious_run.json` lists the results with their hashes: only a file that is listed and was not changed since is ever
/// removed or replaced. If the program is killed during the exchange, the next run finishes it. What a killed run
/// leaves otherwise is kept, as `unfinished_run_1` and so on.
#[derive(Debug)]
pub struct RunFolder {
    folder: Folder,
    unfinished: Folder,
    /// The results of the earlier run.
    earlier: Marker,
    /// The names of results that are written directly.
    adopted: BTreeSet<String>,
    /// Locked while it is open, if the file system has locks.
    _locked: File,
    /// Whether there was no such folder before.
    is_new: bool,
    /// Whether the subfolder stays, because its results could not be moved.
    keeps_unfinished: bool,
    notes: Vec<String>,
}

impl RunFolder {
    /// Opens the folder for one run; the folder is made unless it exists. An exchange that a killed run has begun is
    /// finished.
    ///
    /// # Errors
    ///
    /// When the folder cannot be written, when another run is writing to it, or when results would replace a file that
    /// no run wrote, or that was changed since ([`OutputError::is_refusal`]).
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        let failed = |why| OutputError::new(path, why);
        let is_new = !path.exists();
        if !is_new {
            check_folder(&Folder::open(path).map_err(failed)?)?; // before anything is made
        }
        make_folder(path)?;
        let folder = Folder::open(path).map_err(failed)?;
        let unfinished = folder.make_inner(UNFINISHED)?;
        let locked = lock_folder(&folder, &unfinished)?;
        let mut notes = Vec::new();
        // Again: another run may have ended it.
        let mut earlier = Marker::read(&folder, RESULTS)?;
        if let Some(exchange) = Exchange::begun(&unfinished)? {
            exchange.carry_out(&folder, &unfinished, &mut Moves::default())?;
            exchange.clean_up(&unfinished)?;
            notes.push(format!("the results of a run that was killed are now in {}", path.display()));
            earlier = exchange.new;
        }
        notes.extend(keep_left_over(&folder, &unfinished)?);
        let changed = earlier.names().filter(|name| !folder.is_free(name) && !earlier.proves(&folder, name));
        notes.extend(changed.map(|name| {
            format!("{} was changed since a run wrote it: it stays", folder.join(name).display())
        }));
        check_names(&folder, &earlier)?;
        Ok(Self {
            folder,
            unfinished,
            earlier,
            adopted: BTreeSet::new(),
            _locked: locked,
            is_new,
            keeps_unfinished: false,
            notes,
        })
    }

    /// What the user should know: files that stay, an exchange that was finished. One sentence each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The folder to write to.
    pub fn unfinished(&self) -> &Path {
        &self.unfinished.path
    }

    /// The path to write a result to that is known by its name early, before the work on it.
    ///
    /// # Errors
    ///
    /// When it would replace a file that no run wrote ([`OutputError::is_refusal`]).
    pub fn reserve(&self, name: &str) -> Result<PathBuf, OutputError> {
        self.earlier.check_result(&self.folder, name)?;
        Ok(self.unfinished.join(name))
    }

    /// Counts a file that is written directly as a result of this run, if it is in this folder. Its name must have an
    /// `ending`, so that it is not the name of another result.
    ///
    /// # Errors
    ///
    /// When the name has another ending, or when the file would be in the subfolder of the unfinished run.
    pub fn adopt(&mut self, path: &Path, ending: &str) -> Result<(), OutputError> {
        let folder = path.parent().map(|folder| if folder == "" { Path::new(".") } else { folder });
        let is_in = |own: &Folder| folder.is_some_and(|folder| own.is_at(folder));
        if is_in(&self.unfinished) {
            let why = "this folder is removed at the end of the run; choose another one";
            return Err(OutputError::new(path, io::Error::other(why)));
        }
        let Some(name) = path.file_name().and_then(OsStr::to_str).filter(|_| is_in(&self.folder)) else {
            return Ok(());
        };
        if path.extension().is_none_or(|own| own != ending) {
            let why = format!("in the folder of the results its name must end in .{ending}");
            return Err(OutputError::new(path, io::Error::other(why)));
        }
        self.adopted.insert(name.to_owned());
        Ok(())
    }

    /// The names of the results so far, sorted.
    ///
    /// # Errors
    ///
    /// When the folder cannot be read.
    pub fn results(&self) -> Result<Vec<String>, OutputError> {
        let mut names = self.written()?;
        names.extend(self.adopted.iter().cloned());
        Ok(names.into_iter().collect())
    }

    /// The names of the files that the run has written into the subfolder: somebody else may have put one there.
    fn written(&self) -> Result<BTreeSet<String>, OutputError> {
        if !self.unfinished.is_at(&self.unfinished.path) {
            let why = "the folder was moved or removed while the run wrote to it: its results are lost";
            return Err(self.failed(io::Error::other(why)));
        }
        let written = Marker::read(&self.unfinished, marker::FILES)?;
        let names = written.names().filter(|name| written.proves(&self.unfinished, name));
        Ok(names.cloned().collect())
    }

    /// Replaces the results of the earlier run, except `inputs` of this one and what is in them, by the files
    /// that were written. The file with the summary comes last.
    ///
    /// # Errors
    ///
    /// When a file cannot be renamed, or would replace a file that no run wrote. The earlier results are put back then,
    /// and the new ones stay in the subfolder.
    pub fn finish(mut self, inputs: &[&Path]) -> Result<(), OutputError> {
        let exchanged = self.exchange(inputs);
        exchanged.map_err(|error| {
            self.keeps_unfinished = true;
            let why = format!("{}; the results are in {}", error.why, self.unfinished.path.display());
            OutputError::new(&error.path, io::Error::new(error.why.kind(), why))
        })
    }

    fn exchange(&self, inputs: &[&Path]) -> Result<(), OutputError> {
        let Self { folder, unfinished, .. } = self;
        let mut new = Marker::new();
        for name in self.written()? {
            self.earlier.check_result(folder, &name)?;
            new.add(unfinished, &name).map_err(|why| self.failed(why))?;
        }
        let is_kept = |name: &str| inputs.iter().any(|input| is_below(&folder.join(name), input));
        let earlier =
            self.earlier.without(|name| self.adopted.contains(name) || is_kept(name) && !new.lists(name));
        // Not what somebody else has put in their place.
        let named = Marker::read(folder, marker::FILES)?;
        for name in self.adopted.iter().filter(|name| named.proves(folder, name)) {
            new.add(folder, name).map_err(|why| self.failed(why))?;
        }
        let exchange = Exchange { earlier, new };
        exchange.begin(unfinished)?;
        let mut moves = Moves::default();
        exchange.carry_out(folder, unfinished, &mut moves).inspect_err(|_| {
            // What cannot be put back is finished by the next run.
            exchange.undo(folder, unfinished, &moves).ok();
        })?;
        exchange.clean_up(unfinished).ok(); // the next run does it
        Ok(())
    }

    fn failed(&self, why: io::Error) -> OutputError {
        OutputError::new(&self.folder.path, why)
    }
}

impl Drop for RunFolder {
    fn drop(&mut self) {
        if self.keeps_unfinished {
            return;
        }
        // What fails has a reason that was reported, or is kept by the next run.
        remove_unfinished(&self.folder, &self.unfinished).ok();
        if self.is_new {
            fs::remove_dir(&self.folder.path).ok(); // only if it is empty
        }
    }
}

/// Removes what the run has written into the subfolder, and the subfolder, in which the lock goes last. What is not of a run stays,
/// and with it the lock.
fn remove_unfinished(folder: &Folder, unfinished: &Folder) -> Result<(), OutputError> {
    if remove_files(unfinished)? {
        unfinished.remove(LOCK)?;
        folder.remove_inner(UNFINISHED)?;
    }
    Ok(())
}

/// Removes what a run has written into a subfolder, complete or not; whether nothing else is in it than the lock.
fn remove_files(unfinished: &Folder) -> Result<bool, OutputError> {
    let written = Marker::read(unfinished, marker::FILES)?;
    let is_written = |name: &OsStr| {
        is_temporary(name) || name.to_str().is_some_and(|name| written.proves(unfinished, name))
    };
    let names = unfinished.names().map_err(|why| OutputError::new(&unfinished.path, why))?;
    let (own, others): (Vec<_>, Vec<_>) = names.iter().partition(|name| is_written(name));
    own.into_iter().try_for_each(|name| unfinished.remove(name))?;
    let is_alone = others.iter().all(|name| *name == LOCK || *name == marker::FILES);
    if is_alone {
        unfinished.remove(marker::FILES)?;
    }
    Ok(is_alone)
}

/// Checks that a folder is none of a run that goes on, that what it has of an unfinished run is of a run, and
/// that no result would replace another file.
fn check_folder(folder: &Folder) -> Result<(), OutputError> {
    if marker::is_of_a_run(folder) {
        let why = "a run writes there, or has left it when it was killed; give another folder by --out";
        return Err(OutputError::refused(&folder.path, why.into()));
    }
    let earlier = Marker::read(folder, RESULTS)?;
    if folder.is_free(UNFINISHED) {
        return check_names(folder, &earlier);
    }
    let path = folder.join(UNFINISHED);
    let failed = |why| OutputError::new(&path, why);
    let unfinished = folder.inner(UNFINISHED).ok();
    let names = unfinished.as_ref().map_or(Ok(Vec::new()), Folder::names).map_err(failed)?;
    let lock =
        unfinished.as_ref().map_or(Ok(None), |folder| folder.read(LOCK)).map(Option::unwrap_or_default);
    let lock = lock.unwrap_or_else(|_| b"not a file".into());
    let is_alone = lock.is_empty() && names.iter().all(|name| name == LOCK);
    let Some(unfinished) = unfinished.filter(|_| lock == LOCK_CONTENT || is_alone) else {
        let why = "it is not a folder that a run of this version has left; move it, or give another folder by --out";
        return Err(OutputError::refused(&path, why.into()));
    };
    // An exchange that was begun is finished first.
    if Exchange::begun(&unfinished)?.is_none() { check_names(folder, &earlier) } else { Ok(()) }
}

/// Checks that the results of no run would replace a file that no run wrote.
fn check_names(folder: &Folder, earlier: &Marker) -> Result<(), OutputError> {
    NAMES.split(' ').try_for_each(|name| earlier.check_result(folder, name))
}

/// Locks the inner folder.
fn lock_folder(folder: &Folder, unfinished: &Folder) -> Result<File, OutputError> {
    let failed = |why| OutputError::new(&folder.path, why);
    let mut locked = unfinished.file_to_write(LOCK).map_err(failed)?;
    lock(&locked, &folder.path, "wait for it, or give this one another folder by --out")?;
    locked.write_all(LOCK_CONTENT).map_err(failed)?;
    Ok(locked)
}

/// Moves what a killed run has left into a folder of its own.
fn keep_left_over(folder: &Folder, unfinished: &Folder) -> Result<Option<String>, OutputError> {
    let names = unfinished.names().map_err(|why| OutputError::new(&unfinished.path, why))?;
    let left: Vec<OsString> = names.into_iter().filter(|name| name != LOCK).collect();
    if left.iter().all(|name| name == marker::FILES) {
        unfinished.remove(marker::FILES)?;
        return Ok(None);
    }
    let names: Vec<String> = (1..=MAX_LEFT).map(|number| format!("{UNFINISHED}_{number}")).collect();
    let free = names.iter().find(|name| folder.is_free(name)).cloned();
    let Some(free) = free.or_else(|| removed(folder, names)) else {
        let why = format!(
            "it has what killed runs have left in {UNFINISHED}_1 to {UNFINISHED}_{MAX_LEFT}; remove those folders that are not needed"
        );
        return Err(OutputError::refused(&folder.path, why));
    };
    let kept = folder.make_inner(&free)?;
    left.iter().try_for_each(|name| unfinished.rename(name, &kept, name))?;
    let path = kept.path.display();
    Ok(Some(format!("{path} has what a killed run has left; remove it if it is not needed")))
}

/// Removes the oldest of these folders that has only what a killed run has left, and returns its name.
fn removed(folder: &Folder, mut names: Vec<String>) -> Option<String> {
    names.sort_by_key(|name| {
        folder.find(name).ok().flatten().map(|found| (found.st_mtime, found.st_mtime_nsec))
    });
    names.into_iter().find(|name| {
        folder.inner(name).is_ok_and(|left| remove_files(&left).is_ok_and(|is_alone| is_alone))
            && folder.remove_inner(name).is_ok()
    })
}

/// Whether a file is the same as another one, or is in or below a folder.
pub fn is_below(file: &Path, other: &Path) -> bool {
    let folder = file.parent().map(|folder| if folder == "" { Path::new(".") } else { folder });
    let folder = folder.and_then(|folder| folder.canonicalize().ok());
    let path = folder.zip(file.file_name()).map(|(folder, name)| folder.join(name));
    path.is_some_and(|path| other.canonicalize().is_ok_and(|other| path.starts_with(other)))
}

#[cfg(test)]
mod tests;

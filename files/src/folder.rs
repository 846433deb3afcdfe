//! The folder of a run's results.

use super::exchange::{Exchange, Moves, check_replaceable};
use super::{OutputError, disk, lock, make_folder};
use crate::exchange::Marker;
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The folder for the files of a run that goes on, inside the folder of the results.
const UNFINISHED: &str = "unfinished_run";
/// The file in it that a run locks, and its content: without it, the folder is not one of a run.
const LOCK: &str = ".lock";
const LOCK_CONTENT: &[u8] =
    b"A run of curious writes here. What a killed run leaves is kept by the next one.\n";
/// Results of the programs whose names do not depend on the world: a folder that has other files with these names is
/// refused before the run. Other names are checked at the end.
const RESULTS: &str = "\
    map_log.rrd summary.json report.json report.html trials.csv map.pgm map.yaml \
    permanent.pgm permanent.yaml speed_mask.pgm speed_mask.yaml keepout_mask.pgm keepout_mask.yaml \
    cell_statistics.csv things.json layers.npy layers.json trajectory.tum trajectory_true.tum \
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
    path: PathBuf,
    unfinished: PathBuf,
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
        if disk::read(&path.join(LOCK)).is_ok_and(|lock| lock.as_deref() == Some(LOCK_CONTENT)) {
            let why = "a run writes there, or has left it when it was killed; give another folder by --out";
            return Err(OutputError::refused(path, why.into()));
        }
        let is_new = !path.exists();
        let unfinished = path.join(UNFINISHED);
        let mut earlier = Marker::read(path)?;
        check_unfinished(&unfinished)?;
        let failed = |why| OutputError::new(path, why);
        let begun = Exchange::begun(&unfinished)?;
        if begun.is_none() {
            check_names(path, &earlier)?; // before anything is made
        }
        let locked = lock_folder(path, &unfinished)?;
        let mut notes = Vec::new();
        // Again: another run may have ended it.
        if let Some(exchange) = Exchange::begun(&unfinished)? {
            exchange.carry_out(path, &unfinished, &mut Moves::default())?;
            Exchange::clean_up(&unfinished)?;
            notes.push(format!("the results of a run that was killed are now in {}", path.display()));
            earlier = exchange.new;
        }
        notes.extend(keep_left_over(path, &unfinished).map_err(failed)?);
        let changed = earlier.names().filter(|name| path.join(name).exists() && !earlier.proves(path, name));
        notes.extend(
            changed.map(|name| {
                format!("{} was changed since a run wrote it: it stays", path.join(name).display())
            }),
        );
        let adopted = BTreeSet::new();
        let folder = Self {
            path: path.to_owned(),
            unfinished,
            earlier,
            adopted,
            _locked: locked,
            is_new,
            keeps_unfinished: false,
            notes,
        };
        check_names(path, &folder.earlier)?;
        Ok(folder)
    }

    /// What the user should know: files that stay, an exchange that was finished. One sentence each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The folder to write to.
    pub fn unfinished(&self) -> &Path {
        &self.unfinished
    }

    /// The path to write a result to that is known by its name early, before the work on it.
    ///
    /// # Errors
    ///
    /// When it would replace a file that no run wrote ([`OutputError::is_refusal`]).
    pub fn reserve(&self, name: &str) -> Result<PathBuf, OutputError> {
        check_replaceable(&self.earlier, &self.path, name)?;
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
        let is_in = |own: &Path| folder.is_some_and(|folder| same(folder, own));
        if is_in(&self.unfinished) {
            let why = "this folder is removed at the end of the run; choose another one";
            return Err(OutputError::new(path, io::Error::other(why)));
        }
        let Some(name) = path.file_name().and_then(OsStr::to_str).filter(|_| is_in(&self.path)) else {
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

    /// The names of the files in the subfolder.
    fn written(&self) -> Result<BTreeSet<String>, OutputError> {
        let mut names = BTreeSet::new();
        for entry in fs::read_dir(&self.unfinished).map_err(|why| self.failed(why))? {
            let entry = entry.map_err(|why| self.failed(why))?;
            names.extend(entry.file_name().into_string().ok().filter(|_| !entry.path().is_dir()));
        }
        names.remove(LOCK);
        Ok(names)
    }

    /// Replaces the results of the earlier run, except `inputs` of this one, by the files that were written. The file with
    /// the summary comes last.
    ///
    /// # Errors
    ///
    /// When a file cannot be renamed, or would replace a file that no run wrote. The earlier results are put back then,
    /// and the new ones stay in the subfolder.
    pub fn finish(mut self, inputs: &[&Path]) -> Result<(), OutputError> {
        let exchanged = self.exchange(inputs);
        exchanged.map_err(|error| {
            self.keeps_unfinished = true;
            let why = format!("{}; the results are in {}", error.why, self.unfinished.display());
            OutputError::new(&error.path, io::Error::new(error.why.kind(), why))
        })
    }

    fn exchange(&self, inputs: &[&Path]) -> Result<(), OutputError> {
        let mut new = Marker::new();
        for name in self.written()? {
            check_replaceable(&self.earlier, &self.path, &name)?;
            new.add(&self.unfinished, &name).map_err(|why| self.failed(why))?;
        }
        let is_kept = |name: &str| inputs.iter().any(|input| same(input, &self.path.join(name)));
        let earlier =
            self.earlier.without(|name| self.adopted.contains(name) || is_kept(name) && !new.lists(name));
        for name in self.adopted.iter().filter(|name| self.path.join(name).is_file()) {
            new.add(&self.path, name).map_err(|why| self.failed(why))?;
        }
        let exchange = Exchange { earlier, new };
        exchange.begin(&self.unfinished)?;
        let mut moves = Moves::default();
        exchange.carry_out(&self.path, &self.unfinished, &mut moves).inspect_err(|_| {
            // What cannot be put back is finished by the next run.
            Exchange::undo(&self.unfinished, &moves).ok();
        })?;
        Exchange::clean_up(&self.unfinished).ok(); // the next run does it
        Ok(())
    }

    fn failed(&self, why: io::Error) -> OutputError {
        OutputError::new(&self.path, why)
    }
}

impl Drop for RunFolder {
    fn drop(&mut self) {
        if self.keeps_unfinished {
            return;
        }
        // What fails has a reason that was reported, or is kept by the next run.
        disk::remove_run(&self.unfinished, LOCK).ok();
        if self.is_new {
            fs::remove_dir(&self.path).ok(); // only if it is empty
        }
    }
}

/// Checks that there is nothing, or what a run has left.
fn check_unfinished(unfinished: &Path) -> Result<(), OutputError> {
    let entries = match fs::read_dir(unfinished) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        entries => entries.map_err(|why| OutputError::new(unfinished, why))?,
    };
    let lock = disk::read(&unfinished.join(LOCK)).map(Option::unwrap_or_default);
    let lock = lock.unwrap_or_else(|_| b"not a file".into());
    let is_alone = lock.is_empty() && entries.flatten().all(|entry| entry.file_name() == LOCK);
    let is_link = unfinished.symlink_metadata().is_ok_and(|known| known.is_symlink());
    if !is_link && (lock == LOCK_CONTENT || is_alone) {
        return Ok(());
    }
    let why =
        "it is not a folder that a run of this version has left; move it, or give another folder by --out";
    Err(OutputError::refused(unfinished, why.into()))
}

/// Checks that the results of no run would replace a file that no run wrote.
fn check_names(path: &Path, earlier: &Marker) -> Result<(), OutputError> {
    RESULTS.split(' ').try_for_each(|name| check_replaceable(earlier, path, name))
}

/// Makes both folders, and locks the inner one.
fn lock_folder(path: &Path, unfinished: &Path) -> Result<File, OutputError> {
    make_folder(unfinished)?;
    let failed = |why| OutputError::new(path, why);
    let file = unfinished.join(LOCK);
    let mut locked = File::options().write(true).create(true).truncate(false).open(file).map_err(failed)?;
    lock(&locked, path, "wait for it, or give this one another folder by --out")?;
    locked.write_all(LOCK_CONTENT).map_err(failed)?;
    Ok(locked)
}

/// Moves what a killed run has left into a folder of its own.
fn keep_left_over(path: &Path, unfinished: &Path) -> io::Result<Option<String>> {
    let left: Vec<_> = fs::read_dir(unfinished)?.collect::<io::Result<_>>()?;
    let left: Vec<_> = left.iter().filter(|entry| entry.file_name() != LOCK).collect();
    if left.is_empty() {
        return Ok(None);
    }
    let mut free = (1..).map(|number| path.join(format!("{UNFINISHED}_{number}")));
    let kept = free.find(|folder| folder.symlink_metadata().is_err()).unwrap_or_default();
    fs::create_dir(&kept)?;
    left.iter().try_for_each(|entry| fs::rename(entry.path(), kept.join(entry.file_name())))?;
    Ok(Some(format!("{} has what a killed run has left; remove it if it is not needed", kept.display())))
}

/// Whether two paths lead to the same file or folder.
fn same(a: &Path, b: &Path) -> bool {
    a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

#[cfg(test)]
mod tests;

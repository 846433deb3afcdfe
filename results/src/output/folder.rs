//! The folder of a run's results.

use super::{OutputError, lock, make_folder};
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// The folder for the files of a run that goes on, inside the folder of the results.
const UNFINISHED: &str = "unfinished_run";
/// The folder for the results of the earlier run while they are replaced, and the file that a run locks, inside of
/// [`UNFINISHED`].
const EARLIER: &str = ".earlier";
const LOCK: &str = ".lock";
/// The files that end a run: they list its results under [`FILES_KEY`].
const SUMMARIES: [&str; 2] = ["summary.json", "report.json"];
/// The key of the names of all results, in a summary.
const FILES_KEY: &str = "files";

/// The folder of the results of one run.
///
/// A run writes into the subfolder `unfinished_run`, [`RunFolder::unfinished`]. At the end the results of the earlier
/// run are replaced by the new ones, the summary last; whatever fails before, the earlier results stay. A killed
/// run leaves the subfolder, as does a run whose results cannot be moved; the next run removes it.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    unfinished: PathBuf,
    /// The names of results that are written directly.
    adopted: BTreeSet<String>,
    /// Locked while it is open, if the file system has locks.
    _locked: File,
    /// Whether there was no such folder before.
    is_new: bool,
    /// Whether the subfolder stays, because its results could not be moved.
    keeps_unfinished: bool,
}

impl RunFolder {
    /// Opens the folder for one run; the folder is made unless it exists. What a killed run has left is removed.
    ///
    /// # Errors
    ///
    /// When the folder cannot be written, or when another run is writing to it.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        let is_new = !path.exists();
        let unfinished = path.join(UNFINISHED);
        make_folder(path)?;
        let failed = |why| OutputError::new(path, why);
        if !is_of_a_run(&unfinished) {
            let why = "it is not a folder that a run has left; give another folder by --out";
            return Err(OutputError::new(&unfinished, io::Error::other(why)));
        }
        fs::create_dir_all(&unfinished).map_err(failed)?;
        let locked = File::create(unfinished.join(LOCK)).map_err(failed)?;
        lock(&locked, path, "wait for it, or give this one another folder by --out")?;
        let folder = Self {
            path: path.to_owned(),
            unfinished,
            adopted: BTreeSet::new(),
            _locked: locked,
            is_new,
            keeps_unfinished: false,
        };
        folder.remove_left_over().map_err(|why| folder.failed(why))?;
        Ok(folder)
    }

    /// Removes the files that a killed run has left.
    fn remove_left_over(&self) -> io::Result<()> {
        for entry in fs::read_dir(&self.unfinished)? {
            let entry = entry?;
            if entry.file_name() == LOCK {
                continue;
            }
            if entry.file_type()?.is_dir() {
                fs::remove_dir_all(entry.path())?;
            } else {
                fs::remove_file(entry.path())?;
            }
        }
        Ok(())
    }

    /// The folder to write to.
    pub fn unfinished(&self) -> &Path {
        &self.unfinished
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
            names.extend(entry.map_err(|why| self.failed(why))?.file_name().into_string().ok());
        }
        names.remove(LOCK);
        Ok(names)
    }

    /// Replaces the results of the earlier run, except `inputs` of this one, by the files that were written. The file
    /// `summary` comes last.
    ///
    /// # Errors
    ///
    /// When a file cannot be renamed. The earlier results are put back then, and the new ones stay in the subfolder.
    pub fn finish(mut self, summary: &str, inputs: &[&Path]) -> Result<(), OutputError> {
        let mut written = Vec::from_iter(self.written()?);
        written.sort_by_key(|name| name == summary);
        let earlier = self.unfinished.join(EARLIER);
        fs::create_dir(&earlier).map_err(|why| OutputError::new(&earlier, why))?;
        // The summary first: without it the other files are no results.
        let mut replaced = SUMMARIES.map(str::to_owned).to_vec();
        replaced.extend(self.earlier_results(inputs));
        replaced.extend(written.iter().cloned());
        replaced.retain(|name| !self.adopted.contains(name));

        let mut moves = Moves::default();
        let moved = self.exchange(&replaced, &written, &mut moves);
        moved.map_err(|error| {
            moves.undo();
            fs::remove_dir(&earlier).ok(); // empty now
            self.keeps_unfinished = true;
            let why = format!("{}; the results are in {}", error.why, self.unfinished.display());
            OutputError::new(&error.path, io::Error::new(error.why.kind(), why))
        })
    }

    /// Moves the files with the names `replaced` away, if there are such files, and those that were written here.
    fn exchange(
        &self,
        replaced: &[String],
        written: &[String],
        moves: &mut Moves,
    ) -> Result<(), OutputError> {
        for name in replaced {
            let (here, earlier) = (self.path.join(name), self.unfinished.join(EARLIER).join(name));
            // A name can be there twice.
            if here.is_file() {
                moves.add(here, earlier)?;
            }
        }
        written.iter().try_for_each(|name| moves.add(self.unfinished.join(name), self.path.join(name)))
    }

    fn failed(&self, why: io::Error) -> OutputError {
        OutputError::new(&self.path, why)
    }

    /// The files that the summaries of earlier runs list, without `inputs`.
    fn earlier_results(&self, inputs: &[&Path]) -> Vec<String> {
        let listed = SUMMARIES.iter().filter_map(|name| fs::read(self.path.join(name)).ok());
        let listed = listed.filter_map(|text| serde_json::from_slice::<serde_json::Value>(&text).ok());
        let names: BTreeSet<String> = listed
            .filter_map(|summary| serde_json::from_value::<Vec<String>>(summary[FILES_KEY].clone()).ok())
            .flatten()
            .collect();
        // Only files in this folder, whatever a summary says.
        let is_plain =
            |name: &String| Path::new(name).file_name().is_some_and(|plain| plain == name.as_str());
        let is_input = |name: &String| inputs.iter().any(|input| same(input, &self.path.join(name)));
        names.into_iter().filter(|name| is_plain(name) && !is_input(name)).collect()
    }
}

impl Drop for RunFolder {
    fn drop(&mut self) {
        if self.keeps_unfinished {
            return;
        }
        // What fails has a reason that was reported, or is removed by the next run.
        fs::remove_dir_all(&self.unfinished).ok();
        if self.is_new {
            fs::remove_dir(&self.path).ok(); // only if it is empty
        }
    }
}

/// Files that were moved, from and to.
#[derive(Default)]
struct Moves(Vec<(PathBuf, PathBuf)>);

impl Moves {
    fn add(&mut self, from: PathBuf, to: PathBuf) -> Result<(), OutputError> {
        fs::rename(&from, &to).map_err(|why| OutputError::new(&to, why))?;
        self.0.push((from, to));
        Ok(())
    }

    fn undo(&self) {
        for (from, to) in self.0.iter().rev() {
            fs::rename(to, from).ok(); // the first error is reported
        }
    }
}

/// Whether there is nothing, or what a run has left: nothing else is removed.
fn is_of_a_run(unfinished: &Path) -> bool {
    let is_empty = || fs::read_dir(unfinished).is_ok_and(|mut files| files.next().is_none());
    match fs::symlink_metadata(unfinished) {
        Ok(known) => known.is_dir() && (unfinished.join(LOCK).is_file() || is_empty()),
        Err(error) => error.kind() == io::ErrorKind::NotFound,
    }
}

/// Whether two paths lead to the same file or folder.
fn same(a: &Path, b: &Path) -> bool {
    a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// A run that writes files, and a summary that lists them.
    fn run(path: &Path, files: &[&str], inputs: &[&Path]) -> Result<(), OutputError> {
        let folder = RunFolder::open(path).unwrap();
        for file in files {
            fs::write(folder.unfinished().join(file), format!("{file} of {files:?}")).unwrap();
        }
        let summary = serde_json::json!({ FILES_KEY: folder.results().unwrap() });
        fs::write(folder.unfinished().join("summary.json"), summary.to_string()).unwrap();
        folder.finish("summary.json", inputs)
    }

    #[test]
    fn a_folder_holds_one_run() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b");
        run(&path, &["map.pgm", "house.rrd", "a.toml", "b.toml"], &[]).unwrap();
        fs::write(path.join("notes.txt"), "of the user").unwrap();
        run(&path, &["map.pgm"], &[&path.join("b.toml")]).unwrap();
        assert_eq!(names(&path), ["b.toml", "map.pgm", "notes.txt", "summary.json"]);
        assert_eq!(fs::read_to_string(path.join("map.pgm")).unwrap(), "map.pgm of [\"map.pgm\"]");
    }

    #[test]
    fn a_file_that_is_written_directly_is_a_result() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("own.rrd");
        for text in ["first", "second"] {
            let mut run = RunFolder::open(folder.path()).unwrap();
            run.adopt(&file, "rrd").unwrap();
            run.adopt(Path::new("elsewhere"), "rrd").unwrap();
            for wrong in ["map.pgm", "unfinished_run/own.rrd"] {
                run.adopt(&folder.path().join(wrong), "rrd").unwrap_err();
            }
            fs::write(&file, text).unwrap();
            assert_eq!(run.results().unwrap(), ["own.rrd"]);
            let summary = serde_json::json!({ FILES_KEY: run.results().unwrap() });
            fs::write(run.unfinished().join("summary.json"), summary.to_string()).unwrap();
            run.finish("summary.json", &[]).unwrap();
            assert_eq!(fs::read_to_string(&file).unwrap(), text);
        }
        run(folder.path(), &["map.pgm"], &[]).unwrap();
        assert_eq!(names(folder.path()), ["map.pgm", "summary.json"]);
    }

    #[test]
    fn a_failed_run_leaves_the_earlier_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        run(&path, &["map.pgm", "house.rrd"], &[]).unwrap();
        let failing = RunFolder::open(&path).unwrap();
        fs::write(failing.unfinished().join("map.pgm"), "half").unwrap();
        drop(failing);
        fs::create_dir(path.join("taken.png")).unwrap();
        run(&path, &["a.png", "map.pgm", "taken.png"], &[]).unwrap_err();
        let left = ["house.rrd", "map.pgm", "summary.json", "taken.png", UNFINISHED];
        assert_eq!(names(&path), left);
        assert!(path.join(UNFINISHED).join("a.png").exists(), "the new results are not lost");
        let map = fs::read_to_string(path.join("map.pgm")).unwrap();
        assert_eq!(map, "map.pgm of [\"map.pgm\", \"house.rrd\"]");
        let new = folder.path().join("new");
        drop(RunFolder::open(&new).unwrap());
        assert!(!new.exists());
    }

    #[test]
    fn a_killed_run_leaves_its_files_until_the_next_run() {
        let folder = tempfile::tempdir().unwrap();
        let unfinished = folder.path().join(UNFINISHED);
        fs::create_dir_all(unfinished.join(EARLIER)).unwrap();
        fs::write(unfinished.join(LOCK), "").unwrap();
        fs::write(unfinished.join("house.rrd"), "half").unwrap();
        run(folder.path(), &["map.pgm"], &[]).unwrap();
        assert_eq!(names(folder.path()), ["map.pgm", "summary.json"]);
    }

    #[test]
    fn only_what_a_run_has_left_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let notes = folder.path().join(UNFINISHED).join("notes.txt");
        fs::create_dir(folder.path().join(UNFINISHED)).unwrap();
        fs::write(&notes, "of the user").unwrap();
        RunFolder::open(folder.path()).unwrap_err();
        assert!(notes.exists());
    }

    #[test]
    fn two_runs_at_once_are_one_too_many() {
        let folder = tempfile::tempdir().unwrap();
        let first = RunFolder::open(folder.path()).unwrap();
        let error = RunFolder::open(folder.path()).unwrap_err().to_string();
        assert_eq!(
            error,
            format!(
                "cannot write {}: another run is writing there; wait for it, or give this one another folder by \
                 --out",
                folder.path().display()
            )
        );
        drop(first);
        RunFolder::open(folder.path()).unwrap();
    }

    #[test]
    fn a_summary_from_elsewhere_removes_nothing_outside() {
        let folder = tempfile::tempdir().unwrap();
        let precious = folder.path().join("precious");
        fs::write(&precious, "").unwrap();
        let path = folder.path().join("out");
        fs::create_dir(&path).unwrap();
        fs::write(path.join("summary.json"), r#"{"files": ["../precious", ".", "..", "", "/"]}"#).unwrap();
        run(&path, &["map.pgm"], &[]).unwrap();
        assert!(precious.exists());
    }
}

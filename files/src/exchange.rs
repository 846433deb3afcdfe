//! The exchange of the results of the earlier run for those of this one.
//!
//! A journal is written before the first file moves, when all new results are complete. Whatever ends the program then,
//! the next run finds the journal and finishes the exchange: each step does nothing if it was done before.

use super::{OutputError, disk};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::Xxh3;

/// The journal, and the folder for the results of the earlier run, inside the folder of the unfinished run.
const JOURNAL: &str = ".exchange.json";
const EARLIER: &str = ".earlier";
/// The files that end a run.
const SUMMARIES: [&str; 2] = ["summary.json", "report.json"];

/// What is exchanged.
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Exchange {
    /// The results of the earlier run that are replaced or removed.
    pub(super) earlier: Marker,
    /// The results of this run.
    pub(super) new: Marker,
}

impl Exchange {
    /// The exchange that was begun in this folder of an unfinished run.
    ///
    /// # Errors
    ///
    /// When the journal cannot be read.
    pub(super) fn begun(unfinished: &Path) -> Result<Option<Self>, OutputError> {
        let path = unfinished.join(JOURNAL);
        let Some(text) = disk::read(&path).map_err(|why| OutputError::new(&path, why))? else {
            return Ok(None);
        };
        let begun = serde_json::from_slice(&text).ok();
        let begun = begun.filter(|begun: &Self| begun.earlier.is_valid() && begun.new.is_valid());
        let why = "no run of this version has left it; move its folder, or give another one by --out";
        begun.map(Some).ok_or_else(|| OutputError::refused(&path, why.into()))
    }

    /// Writes the journal: from now on the exchange is finished, by this run or by the next one.
    pub(super) fn begin(&self, unfinished: &Path) -> Result<(), OutputError> {
        // After a loss of power as well, a journal belongs to complete results.
        let mut written = self.new.names().map(|name| unfinished.join(name)).filter(|path| path.is_file());
        written.try_for_each(|path| disk::sync(&path))?;
        disk::write(&unfinished.join(JOURNAL), &json(self))
    }

    /// Moves the files, those of the earlier run first, and writes the marker. `moves` are the files that were moved.
    ///
    /// # Errors
    ///
    /// When a file cannot be moved, or when a new result would replace a file that is not proven to be a result.
    pub(super) fn carry_out(
        &self,
        folder: &Path,
        unfinished: &Path,
        moves: &mut Moves,
    ) -> Result<(), OutputError> {
        let is_waiting = |name: &str| unfinished.join(name).is_file();
        for name in self.new.names().filter(|name| is_waiting(name)) {
            check_replaceable(&self.earlier, folder, name)?;
        }
        disk::make_folder(&unfinished.join(EARLIER))?;
        let is_replaced = |name: &&String| is_waiting(name) || !self.new.lists(name);
        // The summary goes first and comes last: without it the other files are no results.
        let (summaries, others) = split(self.earlier.names().filter(is_replaced));
        for name in summaries.into_iter().chain(others).filter(|name| self.earlier.proves(folder, name)) {
            moves.add(folder.join(name), unfinished.join(EARLIER).join(name))?;
        }
        let (summaries, others) = split(self.new.names().filter(|name| is_waiting(name)));
        for name in others.into_iter().chain(summaries) {
            moves.add(unfinished.join(name), folder.join(name))?;
        }
        disk::sync(folder)?;
        disk::write(&folder.join(MARKER), &json(&self.new))
    }

    /// Removes what the exchange has left: the results of the earlier run, then the journal.
    pub(super) fn clean_up(unfinished: &Path) -> Result<(), OutputError> {
        disk::remove_folder(&unfinished.join(EARLIER))?;
        disk::remove(&unfinished.join(JOURNAL))
    }

    /// Moves everything back, and removes the journal: the exchange was not begun. What cannot be moved back is finished
    /// by the next run.
    pub(super) fn undo(unfinished: &Path, moves: &Moves) -> Result<(), OutputError> {
        moves.undo()?;
        Self::clean_up(unfinished)
    }
}

/// The names of summaries, and the other names.
fn split<'a>(names: impl Iterator<Item = &'a String>) -> (Vec<&'a String>, Vec<&'a String>) {
    names.partition(|name| SUMMARIES.contains(&name.as_str()))
}

fn json(value: &impl Serialize) -> Vec<u8> {
    serde_json::to_vec_pretty(value).expect("names and numbers")
}

/// Checks that nothing has this name in the folder, or that it is a result of the earlier run.
///
/// # Errors
///
/// When it is something else.
pub(super) fn check_replaceable(earlier: &Marker, folder: &Path, name: &str) -> Result<(), OutputError> {
    let path = folder.join(name);
    if path.symlink_metadata().is_err() || earlier.proves(folder, name) {
        return Ok(());
    }
    let why = if earlier.lists(name) {
        "it was changed since a run wrote it, and the results would replace it"
    } else {
        "the results would replace it, and no run of this version wrote it (an earlier version may have)"
    };
    Err(OutputError::refused(&path, format!("{why}; move it, or give another folder by --out")))
}

/// Files that were moved, from and to.
#[derive(Debug, Default)]
pub(super) struct Moves(Vec<(PathBuf, PathBuf)>);

impl Moves {
    fn add(&mut self, from: PathBuf, to: PathBuf) -> Result<(), OutputError> {
        disk::rename(&from, &to)?;
        self.0.push((from, to));
        Ok(())
    }

    fn undo(&self) -> Result<(), OutputError> {
        self.0.iter().rev().try_for_each(|(from, to)| disk::rename(to, from))
    }
}

// The marker of a folder: which files in it a run wrote, and how they looked then.

/// The file of the marker, in the folder of the results.
pub(super) const MARKER: &str = ".curious_run.json";
/// The schema of the marker; count up when its layout changes.
const SCHEMA: u32 = 1;

/// What a run says of the results that it wrote. Only files that are still as they were written count as results of a
/// run, and only these are ever removed or replaced.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Marker {
    schema: u32,
    /// The content of every result, by its plain name.
    files: BTreeMap<String, Content>,
}

/// The length in bytes, and the hash (XXH3-128, hexadecimal), of a file.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(deny_unknown_fields)]
struct Content {
    bytes: u64,
    xxh3: String,
}

impl Marker {
    /// The marker of a run without results.
    pub(super) fn new() -> Self {
        Self { schema: SCHEMA, files: BTreeMap::new() }
    }

    /// The marker of a folder, or one without files if the folder has none.
    ///
    /// # Errors
    ///
    /// When it cannot be read, or is not a marker of this version.
    pub(super) fn read(folder: &Path) -> Result<Self, OutputError> {
        let path = folder.join(MARKER);
        let invalid = |why: String| {
            OutputError::refused(&path, format!("{why}; move the folder, or give another one by --out"))
        };
        let text = disk::read(&path).map_err(|why| invalid(why.to_string()))?;
        let Some(text) = text else { return Ok(Self::new()) };
        match serde_json::from_slice::<Self>(&text) {
            Ok(marker) if marker.schema != SCHEMA => {
                Err(invalid(format!("it has schema {}, and this program reads {SCHEMA}", marker.schema)))
            }
            Ok(marker) if marker.is_valid() => Ok(marker),
            Ok(_) | Err(_) => Err(invalid("it does not list the results of a run".into())),
        }
    }

    /// Whether it is of this version, and names files in one folder.
    pub(super) fn is_valid(&self) -> bool {
        self.schema == SCHEMA && self.files.keys().all(|name| is_plain(name))
    }

    /// Adds the file with this name in `folder`.
    pub(super) fn add(&mut self, folder: &Path, name: &str) -> io::Result<()> {
        self.files.insert(name.to_owned(), Content::of(&folder.join(name))?);
        Ok(())
    }

    /// This marker without the files of which `is_left_out` holds.
    pub(super) fn without(&self, is_left_out: impl Fn(&str) -> bool) -> Self {
        let files = self.files.iter().filter(|(name, _)| !is_left_out(name));
        let files = files.map(|(name, content)| (name.clone(), content.clone())).collect();
        Self { schema: SCHEMA, files }
    }

    /// The names of the results, sorted.
    pub(super) fn names(&self) -> impl Iterator<Item = &String> {
        self.files.keys()
    }

    pub(super) fn lists(&self, name: &str) -> bool {
        self.files.contains_key(name)
    }

    /// Whether the file in `folder` is a result of this run, and was not changed since.
    pub(super) fn proves(&self, folder: &Path, name: &str) -> bool {
        let path = folder.join(name);
        let is_as_long = |content: &&Content| {
            path.symlink_metadata().is_ok_and(|known| known.is_file() && known.len() == content.bytes)
        };
        let content = self.files.get(name).filter(is_as_long);
        content.is_some_and(|content| Content::of(&path).is_ok_and(|found| found == *content))
    }
}

impl Content {
    fn of(path: &Path) -> io::Result<Self> {
        let mut hash = Xxh3::new();
        let bytes = io::copy(&mut File::open(path)?, &mut hash)?;
        Ok(Self { bytes, xxh3: format!("{:032x}", hash.digest128()) })
    }
}

/// Whether this is the name of a file in a folder, not a path.
fn is_plain(name: &str) -> bool {
    Path::new(name).file_name().is_some_and(|plain| plain == name)
}

//! The exchange of the results of the earlier run for those of this one.
//!
//! A journal is written before the first file moves, when all new results are complete. Whatever ends the program then,
//! the next run finds the journal and finishes the exchange: each step does nothing if it was done before.

use super::OutputError;
use super::disk::Folder;
use super::marker::{EARLIER, JOURNAL, Marker, RESULTS, json};
use serde::{Deserialize, Serialize};

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
    pub(super) fn begun(unfinished: &Folder) -> Result<Option<Self>, OutputError> {
        let path = unfinished.join(JOURNAL);
        let Some(text) = unfinished.read(JOURNAL).map_err(|why| OutputError::new(&path, why))? else {
            return Ok(None);
        };
        let begun = serde_json::from_slice(&text).ok();
        let is_valid = |marker: &Marker| marker.is_valid() && marker.lists_results();
        let begun = begun.filter(|begun: &Self| is_valid(&begun.earlier) && is_valid(&begun.new));
        let why = "no run of this version has left it; move its folder, or give another one by --out";
        begun.map(Some).ok_or_else(|| OutputError::refused(&path, why.into()))
    }

    /// Writes the journal: from now on the exchange is finished, by this run or by the next one.
    pub(super) fn begin(&self, unfinished: &Folder) -> Result<(), OutputError> {
        // After a loss of power as well, a journal belongs to complete results: each of them is on the disk.
        unfinished.write(JOURNAL, &json(self))
    }

    /// Moves the files, those of the earlier run first, and writes the marker. `moves` are the files that were moved.
    ///
    /// # Errors
    ///
    /// When a file cannot be moved, or when a new result would replace a file that is not proven to be a result.
    pub(super) fn carry_out<'a>(
        &'a self,
        folder: &'a Folder,
        unfinished: &'a Folder,
        moves: &mut Moves<'a>,
    ) -> Result<(), OutputError> {
        let is_waiting = |name: &str| unfinished.has_file(name);
        for name in self.new.names().filter(|name| is_waiting(name)) {
            self.earlier.check_result(folder, name)?;
        }
        let earlier = moves.earlier.insert(unfinished.make_inner(EARLIER)?);
        let is_replaced = |name: &&String| is_waiting(name) || !self.new.lists(name);
        // The summary goes first and comes last: without it the other files are no results.
        let (summaries, others) = split(self.earlier.names().filter(is_replaced));
        for name in summaries.into_iter().chain(others).filter(|name| self.earlier.proves(folder, name)) {
            folder.rename(name, earlier, name)?;
            moves.out.push(name);
        }
        let (summaries, others) = split(self.new.names().filter(|name| is_waiting(name)));
        for name in others.into_iter().chain(summaries) {
            unfinished.rename(name, folder, name)?;
            moves.into.push(name);
        }
        folder.sync();
        self.new.write(folder, RESULTS)
    }

    /// Removes what the exchange has left: the results of the earlier run, then the journal.
    pub(super) fn clean_up(&self, unfinished: &Folder) -> Result<(), OutputError> {
        let earlier = unfinished.make_inner(EARLIER)?;
        let mut moved = self.earlier.names().filter(|name| self.earlier.proves(&earlier, name));
        moved.try_for_each(|name| earlier.remove(name))?;
        unfinished.remove_inner(EARLIER)?;
        unfinished.remove(JOURNAL)
    }

    /// Moves everything back, and removes the journal: the exchange was not begun. What cannot be moved back is finished
    /// by the next run.
    pub(super) fn undo(
        &self,
        folder: &Folder,
        unfinished: &Folder,
        moves: &Moves,
    ) -> Result<(), OutputError> {
        moves.into.iter().rev().try_for_each(|name| folder.rename(name, unfinished, name))?;
        if let Some(earlier) = &moves.earlier {
            moves.out.iter().rev().try_for_each(|name| earlier.rename(name, folder, name))?;
        }
        self.clean_up(unfinished)
    }
}

/// The names of summaries, and the other names.
fn split<'a>(names: impl Iterator<Item = &'a String>) -> (Vec<&'a String>, Vec<&'a String>) {
    names.partition(|name| SUMMARIES.contains(&name.as_str()))
}

/// Files that were moved: into the folder of the earlier results, and into the folder of the results.
#[derive(Debug, Default)]
pub(super) struct Moves<'a> {
    earlier: Option<Folder>,
    out: Vec<&'a str>,
    into: Vec<&'a str>,
}

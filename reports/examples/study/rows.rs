//! The table of a study as a file: it gets a line per run as soon as the run ends. A study that was stopped goes on where it was.

use anyhow::{Context, bail};
use rayon::prelude::*;
use reports::pages::PageError;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// A line of the table: a run, and what came of it.
pub(crate) trait Line: Clone + Send + Sync {
    /// What the line is found by.
    type Run: PartialEq + Sync;

    /// The first line of the file.
    fn titles() -> String;

    /// Whether files with this first line can be read.
    fn reads(titles: &str) -> bool {
        titles == Self::titles()
    }

    fn run(&self) -> &Self::Run;

    fn line(&self) -> String;

    fn parse(line: &str) -> anyhow::Result<Self>;
}

/// A file that gets a line per run.
pub(crate) struct RowFile<R> {
    /// The rows that it had when it was opened.
    pub(crate) rows: Vec<R>,
    file: File,
}

impl<R: Line> RowFile<R> {
    /// The rows of a file.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Vec<R>> {
        let text = std::fs::read_to_string(path)?;
        // A line that was cut off has no end.
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut lines = whole.lines();
        if let Some(titles) = lines.next().filter(|titles| !R::reads(titles)) {
            bail!("its first line is not that of this study: {titles}");
        }
        lines
            .enumerate()
            .map(|(at, line)| R::parse(line).with_context(|| format!("line {}", at + 2)))
            .collect()
    }

    /// Opens a file, or begins a new one, to add rows.
    pub(crate) fn open(path: &Path) -> anyhow::Result<Self> {
        let rows = if path.exists() { Self::read(path)? } else { Vec::new() };
        // Without a line that was cut off.
        let mut file = File::create(path)?;
        writeln!(file, "{}", R::titles())?;
        rows.iter().try_for_each(|row| writeln!(file, "{}", row.line()))?;
        Ok(Self { rows, file })
    }

    pub(crate) fn append(&mut self, row: &R) -> anyhow::Result<()> {
        Ok(writeln!(self.file, "{}", row.line())?)
    }
}

/// The rows of several files.
pub(crate) fn merged<R: Line>(paths: &[PathBuf]) -> anyhow::Result<Vec<R>> {
    let read =
        |path: &PathBuf| RowFile::read(path).with_context(|| format!("cannot read {}", path.display()));
    Ok(paths.iter().map(read).collect::<anyhow::Result<Vec<_>>>()?.concat())
}

/// Writes the tables of a page anew.
pub(crate) fn rewrite(
    path: &Path,
    rewritten: impl FnOnce(&str) -> Result<String, PageError>,
) -> anyhow::Result<()> {
    let page = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let page = rewritten(&page).with_context(|| format!("in {}", path.display()))?;
    std::fs::write(path, page).with_context(|| format!("cannot write {}", path.display()))
}

/// A study whose file may have a part of its rows.
pub(crate) struct Study<R> {
    known: Vec<R>,
    file: Option<RowFile<R>>,
}

impl<R: Line> Study<R> {
    /// Opens the file, if there is to be one.
    pub(crate) fn open(path: Option<&Path>) -> anyhow::Result<Self> {
        let file = path.map(RowFile::open).transpose().context("cannot use the file of --csv")?;
        let known = file.as_ref().map_or_else(Vec::new, |file| file.rows.clone());
        Ok(Self { known, file })
    }

    /// The runs that are not in the file.
    pub(crate) fn missing<'r>(&self, runs: &'r [R::Run]) -> Vec<&'r R::Run> {
        runs.iter().filter(|run| !self.known.iter().any(|row| row.run() == *run)).collect()
    }

    /// The rows of all these runs: those that are missing are computed, and added to the file.
    pub(crate) fn complete(
        self,
        runs: &[R::Run],
        row: impl Fn(&R::Run) -> anyhow::Result<R> + Sync,
    ) -> anyhow::Result<Vec<R>> {
        let missing = self.missing(runs);
        let file = Mutex::new(self.file);
        let new = missing.par_iter().map(|run| {
            let row = row(run)?;
            if let Ok(mut file) = file.lock()
                && let Some(file) = file.as_mut()
            {
                file.append(&row)?;
            }
            Ok(row)
        });
        let new: anyhow::Result<Vec<R>> = new.collect();
        let mut rows: Vec<R> = self.known.into_iter().filter(|row| runs.contains(row.run())).collect();
        rows.extend(new?);
        Ok(rows)
    }
}

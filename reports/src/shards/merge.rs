//! All shards of a folder, and their trials in the order of the experiment.

use super::file::shards_in;
use super::scan::{Line, Scan, read_line};
use super::{Header, Shard, ShardError, array};
use evaluation::trials::Trial;
use rayon::prelude::*;
use results::numbers::percent;
use robot::BUILD;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Seek};
use std::path::{Path, PathBuf};

/// The number of trials that are parsed together, on all threads: 8 MB.
const BATCH: usize = 256;

/// The shards of an experiment that have files in a folder.
#[derive(Debug)]
pub struct Shards {
    /// What all shards have in common.
    pub header: Header,
    /// Every shard in their order, with the content of its file; `None` for a shard that was never started.
    scans: Vec<(Shard, Option<Scan>)>,
    folder: PathBuf,
}

impl Shards {
    /// Reads the files of the shards in a folder, which can be written meanwhile.
    ///
    /// # Errors
    ///
    /// When there are no shards, a file cannot be read or is invalid, or the files are not of one experiment.
    pub fn read(folder: &Path) -> Result<Self, ShardError> {
        let mut first: Option<(Header, PathBuf)> = None;
        let mut scans = Vec::new();
        let read = |(shard, path): (Shard, PathBuf)| (Scan::read(&path, shard), shard, path);
        let files: Vec<_> = shards_in(folder)?.into_par_iter().map(read).collect();
        for (scan, shard, path) in files {
            let scan = scan?;
            match (&first, &scan.header) {
                (Some((header, other)), Some(found)) => {
                    if let Some(difference) = found.difference(header) {
                        let why = format!("this shard is {difference} as {}", other.display());
                        return Err(ShardError::content(&path, why));
                    }
                }
                (None, Some(found)) => first = Some((found.clone(), path)),
                (_, None) => {}
            }
            scans.push((shard, scan));
        }
        let Some((header, _)) = first else {
            return Err(ShardError::content(folder, "this folder has no shard with a finished line"));
        };
        let mut all: Vec<_> = header.shard.all().map(|shard| (shard, None)).collect();
        for (shard, scan) in scans.into_iter().filter(|(_, scan)| scan.header.is_some()) {
            all[shard.number() as usize - 1].1 = Some(scan);
        }
        Ok(Self { header, scans: all, folder: folder.to_owned() })
    }

    /// Every shard, with the content of its file; `None` for a shard that was never started.
    pub fn shards(&self) -> impl Iterator<Item = (Shard, Option<&Scan>)> {
        self.scans.iter().map(|(shard, scan)| (*shard, scan.as_ref()))
    }

    /// The shards with trials that are not finished, each with the number of its finished trials.
    fn open(&self) -> impl Iterator<Item = (Shard, u64)> {
        let finished = self.shards().map(|(shard, scan)| (shard, scan.map_or(0, Scan::finished)));
        finished.filter(|(shard, finished)| *finished < shard.trials(self.header.trials))
    }

    /// The shards with trials that are not finished, as `sbatch --array` reads them; `None` if there is none.
    pub fn missing(&self) -> Option<String> {
        let numbers: Vec<u64> = self.open().map(|(shard, _)| shard.number()).collect();
        (!numbers.is_empty()).then(|| array(&numbers))
    }

    /// The present state as text: one line for each shard that is not complete, and one for all shards.
    pub fn status(&self) -> String {
        let trials = self.header.trials;
        let line = |(shard, finished): (Shard, u64)| {
            let done = format!("{finished} of {}", shard.trials(trials));
            format!("shard {:<9} {done:>15} trials\n", shard.to_string())
        };
        let open: String = self.open().map(line).collect();
        let finished: u64 = self.shards().filter_map(|(_, scan)| Some(scan?.finished())).sum();
        let (share, all) = (percent(finished as f64 / trials.max(1) as f64), self.scans.len());
        let complete = all - self.open().count();
        format!("{open}{finished} of {trials} trials ({share}), {complete} of {all} shards complete")
    }

    /// Checks that this program can merge the shards: that they are its own, of its version and of its build, and that no trial
    /// is missing.
    ///
    /// # Errors
    ///
    /// When they are not.
    pub fn check(&self, program: &str, version: &str) -> Result<(), ShardError> {
        let shown = self.folder.display();
        let refuse = |why: String| Err(ShardError::Content(format!("{shown} {why}")));
        let Header { program: found, version: found_version, build, .. } = &self.header;
        if found != program {
            return refuse(format!("has shards of {found}: merge them with `{found} merge {shown}`"));
        }
        for (what, found, own) in [("version", found_version, version), ("build", build, BUILD)] {
            if found != own {
                return refuse(format!("has shards of {what} {found}: merge them with that {what}"));
            }
        }
        let Some((missing, (first, _))) = self.missing().zip(self.open().next()) else { return Ok(()) };
        let (count, file) = (first.count(), first.file_name());
        let which = format!("the shards {missing} of {count} lack trials, the first is {file}");
        refuse(format!("is not complete: {which}; run those shards again"))
    }

    /// All trials in the order of the experiment. They are read a few hundred at a time, and parsed on all threads.
    ///
    /// # Errors
    ///
    /// When a file cannot be opened.
    pub fn trials(&self) -> Result<impl Iterator<Item = Result<Trial, ShardError>>, ShardError> {
        let open = |(shard, _): (Shard, Option<&Scan>)| {
            let path = self.folder.join(shard.file_name());
            let file = files::open(&path).map_err(|why| ShardError::read(&path, why))?;
            Ok((BufReader::with_capacity(1 << 16, file), path))
        };
        let mut files = self.shards().map(open).collect::<Result<Vec<_>, ShardError>>()?;
        let end = self.header.trials + 1;
        let batches = (1..end).step_by(BATCH).map(move |first| first..(first + BATCH as u64).min(end));
        Ok(batches.flat_map(move |numbers| {
            let mut line = |number: u64| {
                let at = ((number - 1) % files.len() as u64) as usize;
                let (file, path) = &mut files[at];
                (number, path.clone(), self.line(number, at, file, path))
            };
            let lines: Vec<_> = numbers.map(&mut line).collect();
            let trial = |(number, path, line): (u64, PathBuf, Result<String, ShardError>)| {
                let read = read_line(line?.trim_end_matches('\n'), self.header.key());
                let changed = || ShardError::content(&path, "the file was changed while it was read");
                read.filter(|line: &Line<_>| line.job == number).map(|line| line.trial).ok_or_else(changed)
            };
            lines.into_par_iter().map(trial).collect::<Vec<_>>()
        }))
    }

    /// The line of a trial, with its end. What is in the buffer is not read again.
    fn line(
        &self,
        number: u64,
        shard: usize,
        file: &mut BufReader<File>,
        path: &Path,
    ) -> Result<String, ShardError> {
        let known = self.scans[shard].1.as_ref().and_then(|scan| scan.lines.get(&number));
        let missing = || ShardError::content(path, format!("trial {number} is missing"));
        let place = *known.ok_or_else(missing)?;
        let mut line = String::new();
        let mut read = || -> io::Result<usize> {
            let from = file.stream_position()?;
            file.seek_relative(place.cast_signed() - from.cast_signed())?;
            file.read_line(&mut line)
        };
        read().map_err(|why| ShardError::read(path, why))?;
        Ok(line)
    }
}

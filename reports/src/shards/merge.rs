//! All shards of a folder, and their trials in the order of the experiment.

use super::file::{check_builds, shards_in};
use super::line::{read, unseal};
use super::scan::Scan;
use super::{Header, SEVERAL_BUILDS, Shard, ShardError, array};
use evaluation::trials::Trial;
use rayon::prelude::*;
use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

/// The number of trials that are parsed together, on all threads: 8 MB.
const BATCH: u64 = 256;

/// The shards of an experiment that have files in a folder.
#[derive(Debug)]
pub struct Shards {
    header: Header,
    /// One per shard, in their order; `None` for a shard without a file.
    scans: Vec<Option<Scan>>,
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
        let count = header.shard().map_or(0, Shard::count);
        let mut all: Vec<Option<Scan>> = (0..count).map(|_| None).collect();
        for (shard, scan) in scans.into_iter().filter(|(_, scan)| scan.header.is_some()) {
            all[shard.number() as usize - 1] = Some(scan);
        }
        Ok(Self { header, scans: all, folder: folder.to_owned() })
    }

    /// What all shards have in common.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Every shard, with the content of its file; `None` for a shard that was never started.
    pub fn shards(&self) -> impl Iterator<Item = (Shard, Option<&Scan>)> {
        let count = self.scans.len() as u64;
        let numbers = (1..=count).filter_map(move |number| Shard::new(number, count));
        numbers.zip(self.scans.iter().map(Option::as_ref))
    }

    /// The numbers of the shards with trials that are not finished.
    pub fn missing(&self) -> Vec<u64> {
        let is_missing = |(shard, scan): &(Shard, Option<&Scan>)| {
            scan.map_or(0, Scan::finished) < shard.trials(self.header.trials)
        };
        self.shards().filter(is_missing).map(|(shard, _)| shard.number()).collect()
    }

    /// Checks that this program can merge the shards: that they are its own, of its version and, unless it allows another
    /// one, of its build, and that no trial is missing. Returns what is said of the build if not all shards are of this one.
    ///
    /// # Errors
    ///
    /// When they are not.
    pub fn check(
        &self,
        program: &str,
        version: &str,
        allows_other_build: bool,
    ) -> Result<Option<&'static str>, ShardError> {
        let refuse = |why: String| Err(ShardError::Merge { folder: self.folder.clone(), why });
        let shown = self.folder.display();
        let Header { program: found, version: found_version, .. } = &self.header;
        if found != program {
            return refuse(format!("has shards of {found}: merge them with `{found} merge {shown}`"));
        }
        if found_version != version {
            return refuse(format!("has shards of version {found_version}: merge them with that version"));
        }
        let other_build = match check_builds(&self.folder) {
            Err(_) if allows_other_build => Some(SEVERAL_BUILDS),
            checked => checked.map(|()| None)?,
        };
        let missing = self.missing();
        let Some((first, count)) = missing.first().zip(self.header.shard().map(Shard::count)) else {
            return Ok(other_build);
        };
        let file = Shard::new(*first, count).map(Shard::file_name).unwrap_or_default();
        let which = format!("the shards {} of {count} lack trials, the first is {file}", array(&missing));
        refuse(format!("is not complete: {which}; run those shards again"))
    }

    /// All trials in the order of the experiment. They are read a few hundred at a time, and parsed on all threads.
    ///
    /// # Errors
    ///
    /// When a file cannot be opened.
    pub fn trials(&self) -> Result<Trials<'_>, ShardError> {
        let mut files = Vec::new();
        for (shard, _) in self.shards() {
            let path = self.folder.join(shard.file_name());
            let file = File::open(&path).map_err(|why| ShardError::read(&path, why))?;
            files.push(LineFile { path, file: BufReader::with_capacity(1 << 16, file), place: 0 });
        }
        Ok(Trials { shards: self, files, next: 1, parsed: VecDeque::new() })
    }
}

/// See [`Shards::trials`].
#[derive(Debug)]
pub struct Trials<'a> {
    shards: &'a Shards,
    /// One per shard.
    files: Vec<LineFile>,
    /// The number of the next trial that is read.
    next: u64,
    /// Trials that are read and not asked for yet.
    parsed: VecDeque<Result<Trial, ShardError>>,
}

#[derive(Debug)]
struct LineFile {
    path: PathBuf,
    file: BufReader<File>,
    /// Where the next byte is read, in bytes from the beginning.
    place: u64,
}

impl LineFile {
    /// The line at a place, with its end. What is in the buffer is not read again.
    fn read(&mut self, place: u64) -> io::Result<String> {
        let mut line = String::new();
        self.file.seek_relative(place.cast_signed() - self.place.cast_signed())?;
        self.place = place + self.file.read_line(&mut line)? as u64;
        Ok(line)
    }
}

impl Trials<'_> {
    /// The position of the shard with a trial.
    fn shard_of(&self, number: u64) -> usize {
        ((number - 1) % self.files.len() as u64) as usize
    }

    /// The line of a trial.
    fn line(&mut self, number: u64) -> Result<String, ShardError> {
        let at = self.shard_of(number);
        let file = &mut self.files[at];
        let known = self.shards.scans[at].as_ref().and_then(|scan| scan.lines.get(&number));
        let missing = || ShardError::content(&file.path, format!("trial {number} is missing"));
        let place = *known.ok_or_else(missing)?;
        file.read(place).map_err(|why| ShardError::read(&file.path, why))
    }

    /// The trial of a line.
    fn parse(&self, number: u64, line: &str) -> Result<Trial, ShardError> {
        let text = unseal(line.trim_end_matches('\n'), self.shards.header.key());
        match text.and_then(read) {
            Some((found, trial)) if found == number => Ok(trial),
            _ => {
                let path = &self.files[self.shard_of(number)].path;
                Err(ShardError::content(path, "the file was changed while it was read"))
            }
        }
    }

    /// Reads the next trials.
    fn parse_batch(&mut self) {
        let numbers = self.next..(self.next + BATCH).min(self.shards.header.trials + 1);
        self.next = numbers.end;
        let lines: Vec<_> = numbers.map(|number| (number, self.line(number))).collect();
        let trial = |(number, line): (u64, Result<String, ShardError>)| self.parse(number, &line?);
        let parsed: Vec<_> = lines.into_par_iter().map(trial).collect();
        self.parsed = parsed.into();
    }
}

impl Iterator for Trials<'_> {
    type Item = Result<Trial, ShardError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.parsed.is_empty() {
            self.parse_batch();
        }
        self.parsed.pop_front()
    }
}

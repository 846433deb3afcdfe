//! All shards of a folder, and their trials in the order of the experiment.

use super::file::shards_in;
use super::line::{read, unseal};
use super::scan::Scan;
use super::{Header, Shard, ShardError};
use crate::report::Trial;
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};

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
        for (shard, path) in shards_in(folder)? {
            let scan = Scan::read(&path, shard)?;
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

    /// All trials in the order of the experiment. Each is read when it is asked for.
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
        Ok(Trials { shards: self, files, next: 1, line: String::new() })
    }
}

/// See [`Shards::trials`].
#[derive(Debug)]
pub struct Trials<'a> {
    shards: &'a Shards,
    /// One per shard.
    files: Vec<LineFile>,
    /// The number of the next trial.
    next: u64,
    line: String,
}

#[derive(Debug)]
struct LineFile {
    path: PathBuf,
    file: BufReader<File>,
    /// Where the next byte is read, in bytes from the beginning.
    place: u64,
}

impl LineFile {
    /// Reads the line at a place. What is in the buffer is not read again.
    fn read(&mut self, place: u64, line: &mut String) -> io::Result<()> {
        line.clear();
        self.file.seek_relative(place.cast_signed() - self.place.cast_signed())?;
        self.place = place + self.file.read_line(line)? as u64;
        Ok(())
    }
}

impl Trials<'_> {
    fn read(&mut self, number: u64) -> Result<Trial, ShardError> {
        let count = self.files.len() as u64;
        let at = ((number - 1) % count) as usize;
        let file = &mut self.files[at];
        let known = self.shards.scans[at].as_ref().and_then(|scan| scan.lines.get(&number));
        let missing = || ShardError::content(&file.path, format!("trial {number} is missing"));
        let place = *known.ok_or_else(missing)?;
        file.read(place, &mut self.line).map_err(|why| ShardError::read(&file.path, why))?;
        let text = unseal(self.line.trim_end_matches('\n'), self.shards.header.key());
        match text.and_then(read) {
            Some((found, trial)) if found == number => Ok(trial),
            _ => Err(ShardError::content(&file.path, "the file was changed while it was read")),
        }
    }
}

impl Iterator for Trials<'_> {
    type Item = Result<Trial, ShardError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.next > self.shards.header.trials {
            return None;
        }
        let number = self.next;
        self.next += 1;
        Some(self.read(number))
    }
}

//! One pass over the file of a shard.

use super::{Header, Shard, ShardError};
use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use xxhash_rust::xxh3::xxh3_64_with_seed;

/// No line is longer, bytes.
pub(super) const MAX_LINE: u64 = 1 << 20;

/// The content of the file of a shard, without the trials themselves.
#[derive(Debug, Default)]
pub struct Scan {
    /// The first line; `None` if it is not complete.
    pub header: Option<Header>,
    /// The place of the line of every finished trial, in bytes from the beginning of the file, by the number of the
    /// trial.
    pub(super) lines: BTreeMap<u64, u64>,
    /// The length of the file up to the end of the last whole line, bytes.
    pub(super) intact: u64,
    /// The text after the last whole line.
    pub(super) torn: Vec<u8>,
}

impl Scan {
    /// Reads the file of a shard. A line that is cut off at the end is no error.
    ///
    /// # Errors
    ///
    /// When the file cannot be read, or a line is not as it was written, is twice in the file, or is of another shard.
    pub(super) fn read(path: &Path, shard: Shard) -> Result<Self, ShardError> {
        let file = files::open(path).map_err(|why| ShardError::read(path, why))?;
        Self::of(path, shard, BufReader::with_capacity(1 << 18, file))
    }

    /// See [`Scan::read`].
    pub(super) fn of(path: &Path, shard: Shard, mut file: impl BufRead) -> Result<Self, ShardError> {
        let mut scan = Self::default();
        let mut key = 0;
        let mut line = Vec::new();
        for number in 1.. {
            line.clear();
            let read = file.by_ref().take(MAX_LINE).read_until(b'\n', &mut line);
            let length = read.map_err(|why| ShardError::read(path, why))? as u64;
            let Some(text) = line.strip_suffix(b"\n") else {
                if length == MAX_LINE {
                    return Err(invalid(path, number, "is not a line of a shard"));
                }
                scan.torn = line;
                break;
            };
            let text = std::str::from_utf8(text).unwrap_or_default();
            if let Some(header) = &scan.header {
                scan.add(text, key, header.trials, shard).map_err(|why| invalid(path, number, &why))?;
            } else {
                let header: Header = read_line(text, 0).ok_or_else(|| not_a_shard(path))?;
                if header.shard != shard {
                    let why = "this is the file of another shard under a new name; give it its name again";
                    return Err(ShardError::content(path, why));
                }
                key = header.key();
                scan.header = Some(header);
            }
            scan.intact += length;
        }
        Ok(scan)
    }

    fn add(&mut self, line: &str, key: u64, trials: u64, shard: Shard) -> Result<(), String> {
        let read = read_line(line, key).map(|Line::<IgnoredAny> { job, .. }| job);
        let job = read.ok_or("is not as it was written: it was edited, or is of another experiment")?;
        if !(1..=trials).contains(&job) || !shard.has(job) {
            return Err(format!("is trial {job}, which does not belong to this shard"));
        }
        if self.lines.insert(job, self.intact).is_some() {
            return Err(format!("is trial {job}, which is in this file before"));
        }
        Ok(())
    }

    /// The number of finished trials.
    pub fn finished(&self) -> u64 {
        self.lines.len() as u64
    }
}

pub(super) fn not_a_shard(path: &Path) -> ShardError {
    ShardError::content(
        path,
        "the first line is not the header of a shard: it was edited, or this is another file",
    )
}

fn invalid(path: &Path, number: u64, what: &str) -> ShardError {
    ShardError::content(path, format!("line {number} {what}; remove the file, and run its shard again"))
}

// The lines of the file of a shard: JSON objects, each with the hash of its text as the last key.

/// What ends the text of a line, before its hash.
const HASH: &str = ",\"hash\":\"";

/// A finished trial with its number.
#[derive(Serialize, Deserialize)]
pub(super) struct Line<T> {
    /// The number of the trial.
    pub(super) job: u64,
    /// The trial; a type without content where only its number is read.
    pub(super) trial: T,
}

/// An object as a line, with a line's end.
pub(super) fn write_line(object: &impl Serialize, key: u64) -> serde_json::Result<String> {
    let text = serde_json::to_string(object)?;
    let text = text.strip_suffix('}').unwrap_or(&text);
    Ok(format!("{text}{HASH}{}\"}}\n", hash(text, key)))
}

/// The object in a line without its end; `None` if the line is not as it was written.
pub(super) fn read_line<T: DeserializeOwned>(line: &str, key: u64) -> Option<T> {
    let (text, found) = line.strip_suffix("\"}")?.rsplit_once(HASH)?;
    (hash(text, key) == found).then(|| serde_json::from_str(&format!("{text}}}")).ok())?
}

fn hash(text: &str, key: u64) -> String {
    format!("{:016x}", xxh3_64_with_seed(text.as_bytes(), key))
}

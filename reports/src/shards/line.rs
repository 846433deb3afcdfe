//! The lines of the file of a shard: JSON objects, each with the hash of its text as the last key.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64_with_seed;

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
pub(super) fn write(object: &impl Serialize, key: u64) -> serde_json::Result<String> {
    let text = serde_json::to_string(object)?;
    let text = text.strip_suffix('}').unwrap_or(&text);
    Ok(format!("{text}{HASH}{}\"}}\n", hash(text, key)))
}

/// The object in a line without its end; `None` if the line is not as it was written.
pub(super) fn read<T: DeserializeOwned>(line: &str, key: u64) -> Option<T> {
    let (text, found) = line.strip_suffix("\"}")?.rsplit_once(HASH)?;
    (hash(text, key) == found).then(|| serde_json::from_str(&format!("{text}}}")).ok())?
}

fn hash(text: &str, key: u64) -> String {
    format!("{:016x}", xxh3_64_with_seed(text.as_bytes(), key))
}

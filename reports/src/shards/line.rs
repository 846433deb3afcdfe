//! The lines of the file of a shard.

use evaluation::trials::Trial;
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

/// The text of a JSON object, with its hash as the last key, and a line's end.
pub(super) fn seal(object: &str, key: u64) -> String {
    let text = object.strip_suffix('}').unwrap_or(object);
    format!("{text}{HASH}{:016x}\"}}\n", xxh3_64_with_seed(text.as_bytes(), key))
}

/// The text of an object without its last brace and its hash; `None` if the line, without its end, is not as it was
/// written.
pub(super) fn unseal(line: &str, key: u64) -> Option<&str> {
    let (text, hash) = line.strip_suffix("\"}")?.rsplit_once(HASH)?;
    (hash == format!("{:016x}", xxh3_64_with_seed(text.as_bytes(), key))).then_some(text)
}

/// The line of the trial with a number, with a line's end.
pub(super) fn write(job: u64, trial: &Trial, key: u64) -> serde_json::Result<String> {
    Ok(seal(&serde_json::to_string(&Line { job, trial })?, key))
}

/// The content of a line without its end; `None` if the line is not as it was written.
pub(super) fn read<T: DeserializeOwned>(line: &str, key: u64) -> Option<Line<T>> {
    serde_json::from_str(&format!("{}}}", unseal(line, key)?)).ok()
}

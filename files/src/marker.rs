//! The marker of a folder: which files in it a run wrote, and how they looked then.

use super::{OutputError, disk};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::path::Path;
use xxhash_rust::xxh3::Xxh3;

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

//! The markers of a folder: which files in it a run wrote, and how they looked then.

use super::OutputError;
use super::disk::Folder;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::File;
use std::io;
use std::path::Path;
use xxhash_rust::xxh3::Xxh3;

/// The marker of the results of a run, which the next run replaces or removes.
pub(super) const RESULTS: &str = ".curious_run.json";
/// The marker of files that were written by their own names, as by `--mcap FILE`. They stay until they are
/// written again.
pub(super) const FILES: &str = ".curious_files.json";
/// The folder for the files of a run that goes on, inside the folder of the results.
pub(super) const UNFINISHED: &str = "unfinished_run";
/// The file in it that a run locks, and its content: without it, the folder is not one of a run.
pub(super) const LOCK: &str = ".lock";
pub(super) const LOCK_CONTENT: &[u8] =
    b"A run of curious writes here. What a killed run leaves is kept by the next one.\n";
/// The journal of an exchange, and the folder for the results of the earlier run, inside the folder of the
/// unfinished run.
pub(super) const JOURNAL: &str = ".exchange.json";
pub(super) const EARLIER: &str = ".earlier";
/// Names that no result has.
const RESERVED: [&str; 6] = [RESULTS, FILES, UNFINISHED, LOCK, JOURNAL, EARLIER];
/// The endings of the names of results.
const ENDINGS: &str = "rrd json html csv pgm yaml npy tum png svg gif mcap toml geojson";
/// The schema of a marker; count up when its layout changes.
const SCHEMA: u32 = 1;

/// What runs say of the files that they wrote in a folder. Only files that are still as they were written
/// count as those of a run, and only these are ever removed or replaced.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Marker {
    schema: u32,
    /// The content of every file, by its plain name.
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

    /// The marker with this name of a folder, or one without files if the folder has none.
    ///
    /// # Errors
    ///
    /// When it cannot be read, or is not a marker of this version.
    pub(super) fn read(folder: &Folder, name: &str) -> Result<Self, OutputError> {
        let advice = if name == FILES { "move it" } else { "move the folder, or give another one by --out" };
        let invalid = |why: String| OutputError::refused(&folder.join(name), format!("{why}; {advice}"));
        let text = folder.read(name).map_err(|why| invalid(why.to_string()))?;
        let Some(text) = text else { return Ok(Self::new()) };
        match serde_json::from_slice::<Self>(&text) {
            Ok(marker) if marker.schema != SCHEMA => {
                Err(invalid(format!("it has schema {}, and this program reads {SCHEMA}", marker.schema)))
            }
            Ok(marker) if marker.is_valid() && (name != RESULTS || marker.lists_results()) => Ok(marker),
            Ok(_) | Err(_) => Err(invalid("it does not list the results of a run".into())),
        }
    }

    /// Whether it is of this version, and names files in one folder that can be results.
    pub(super) fn is_valid(&self) -> bool {
        self.schema == SCHEMA && self.files.keys().all(|name| is_plain(name))
    }

    /// Whether all of its names can be those of results. It can come from a stranger.
    pub(super) fn lists_results(&self) -> bool {
        let has_ending = |ending: &OsStr| ENDINGS.split(' ').any(|known| ending == known);
        self.files.keys().all(|name| Path::new(name).extension().is_some_and(has_ending))
    }

    /// Writes the marker into its folder.
    pub(super) fn write(&self, folder: &Folder, name: &str) -> Result<(), OutputError> {
        folder.write(name, &json(self))
    }

    /// Adds the file with this name in `folder`.
    pub(super) fn add(&mut self, folder: &Folder, name: &str) -> io::Result<()> {
        let file = folder.file(name)?.ok_or(io::ErrorKind::NotFound)?;
        self.files.insert(name.to_owned(), Content::of(file)?);
        Ok(())
    }

    /// This marker without the files of which `is_left_out` holds.
    pub(super) fn without(&self, is_left_out: impl Fn(&str) -> bool) -> Self {
        let files = self.files.iter().filter(|(name, _)| !is_left_out(name));
        let files = files.map(|(name, content)| (name.clone(), content.clone())).collect();
        Self { schema: SCHEMA, files }
    }

    /// The names of the files, sorted.
    pub(super) fn names(&self) -> impl Iterator<Item = &String> {
        self.files.keys()
    }

    pub(super) fn lists(&self, name: &str) -> bool {
        self.files.contains_key(name)
    }

    /// Whether the file in `folder` is one of this marker, and was not changed since.
    pub(super) fn proves(&self, folder: &Folder, name: &str) -> bool {
        let Some(content) = self.files.get(name) else { return false };
        let Ok(Some(file)) = folder.file(name) else { return false };
        let is_as_long = file.metadata().is_ok_and(|known| known.len() == content.bytes);
        is_as_long && Content::of(file).is_ok_and(|found| found == *content)
    }

    /// Checks that nothing has the name of a result in the folder, or that it is a file of this marker.
    ///
    /// # Errors
    ///
    /// When it is something else.
    pub(super) fn check_result(&self, folder: &Folder, name: &str) -> Result<(), OutputError> {
        check(&[self], folder, name, "give another folder by --out")
    }
}

impl Content {
    fn of(mut file: File) -> io::Result<Self> {
        let mut hash = Xxh3::new();
        let bytes = io::copy(&mut file, &mut hash)?;
        Ok(Self { bytes, xxh3: format!("{:032x}", hash.digest128()) })
    }
}

pub(super) fn json(value: &impl Serialize) -> Vec<u8> {
    serde_json::to_vec_pretty(value).expect("names and numbers")
}

/// Whether this is the name of a file in a folder, not a path, and none that a run uses for itself.
pub(super) fn is_plain(name: &str) -> bool {
    Path::new(name).file_name() == Some(OsStr::new(name)) && !RESERVED.contains(&name)
}

/// Whether a run writes to the folder, and lists its files at the end.
pub(super) fn is_of_a_run(folder: &Folder) -> bool {
    folder.read(LOCK).is_ok_and(|lock| lock.as_deref() == Some(LOCK_CONTENT))
}

// Files that are written by their own names.

/// Checks that a run may write a file with this name: nothing has it, or a marker says that a run wrote it.
///
/// # Errors
///
/// When it is something else, or a name that runs use for themselves.
pub(super) fn check_file(folder: &Folder, name: &OsStr) -> Result<(), OutputError> {
    let Some(plain) = name.to_str().filter(|name| is_plain(name)) else {
        let why = "a file of a run has no such name; choose another one";
        return Err(OutputError::refused(&folder.join(name), why.into()));
    };
    let markers = [Marker::read(folder, FILES)?, Marker::read(folder, RESULTS)?];
    let markers = if is_of_a_run(folder) { Vec::new() } else { Vec::from_iter(&markers) };
    check(&markers, folder, plain, "choose another name")
}

fn check(markers: &[&Marker], folder: &Folder, name: &str, advice: &str) -> Result<(), OutputError> {
    let path = folder.join(name);
    let found = folder.find(name).map_err(|why| OutputError::new(&path, why))?;
    if found.is_none() || markers.iter().any(|marker| marker.proves(folder, name)) {
        return Ok(());
    }
    let why = if markers.iter().any(|marker| marker.lists(name)) {
        "it was changed since a run wrote it"
    } else {
        "no run wrote it"
    };
    let why = format!("the results would replace it, and {why}; move it, or {advice}");
    Err(OutputError::refused(&path, why))
}

/// Lists a file that a run wrote, and leaves out what is gone.
pub(super) fn record(folder: &Folder, name: &str) -> Result<(), OutputError> {
    // Other runs list their files in the same marker.
    let lock = folder.to_lock().and_then(|lock| lock.lock().map(|()| lock));
    let mut marker = Marker::read(folder, FILES)?.without(|name| folder.is_free(name));
    marker.add(folder, name).map_err(|why| OutputError::new(&folder.join(name), why))?;
    let written = marker.write(folder, FILES);
    drop(lock);
    written
}

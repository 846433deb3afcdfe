//! The files of a bag: found out by content, put in order, unpacked.

use crate::archive;
use crate::bounds::{self, Unpacked};
use crate::bytes::{Bytes, MCAP, SQLITE, ZSTD};
use crate::summary::LogError;
use serde::Deserialize;
use std::collections::BTreeSet;
use std::fs::{self, DirEntry};
use std::io::{self, Read as _, Seek, Write};
use std::path::{Component, Path};
use std::sync::Arc;
use tempfile::NamedTempFile;

/// The largest `metadata.yaml`.
const MAX_METADATA: u64 = 16 << 20;

/// A file of a bag.
#[derive(Clone, Debug)]
pub(crate) struct BagFile {
    /// Its name in messages.
    pub(crate) name: Arc<str>,
    pub(super) format: Format,
    pub(super) bytes: Bytes,
    /// What is missing, if the file was compressed and is cut off.
    pub(super) missing: Option<String>,
}

/// How a file stores messages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Format {
    Mcap,
    Sqlite,
}

impl Format {
    /// The format of a file that begins with these bytes.
    fn of(start: &[u8]) -> Option<Self> {
        match start {
            _ if start.starts_with(&MCAP) => Some(Self::Mcap),
            _ if start.starts_with(&SQLITE) => Some(Self::Sqlite),
            _ => None,
        }
    }
}

impl BagFile {
    /// A file, if it is one of a bag.
    ///
    /// # Errors
    ///
    /// When it cannot be read, or is of ROS 1.
    pub(crate) fn open(path: &Path) -> Result<Option<Self>, LogError> {
        let name: Arc<str> = path.display().to_string().into();
        Self::recognized(name.clone(), Bytes::File(path.to_owned()))
            .map_err(|why| LogError::Io { file: name.to_string(), why })
    }

    pub(crate) fn recognized(name: Arc<str>, bytes: Bytes) -> io::Result<Option<Self>> {
        let start = bytes.start()?;
        if let Some(format) = Format::of(&start) {
            return Ok(Some(Self { name, format, bytes, missing: None }));
        }
        if let Some(what) = archive::named(&bytes)? {
            return Err(io::Error::new(io::ErrorKind::Unsupported, what));
        }
        if !start.starts_with(&ZSTD) {
            return Ok(None);
        }
        let (format, file, missing) = unpacked(&name, &bytes)?;
        Ok(Some(Self { name, format, bytes: Bytes::Unpacked(Arc::new(file)), missing }))
    }
}

/// A temporary file with the bag that is in a compressed file, and what is missing if that is cut off.
fn unpacked(name: &str, bytes: &Bytes) -> io::Result<(Format, NamedTempFile, Option<String>)> {
    let invalid = |what: String| io::Error::new(io::ErrorKind::InvalidData, what);
    let mut input = bytes.open()?;
    let packed = input.seek(io::SeekFrom::End(0))?;
    input.rewind()?;
    let folder = std::env::temp_dir();
    let decoder = Unpacked::new(zstd::stream::read::Decoder::new(input)?, packed, "zstd -d FILE");
    let mut decoder = decoder.into_folder(&folder, bounds::free_bytes(&folder));
    let mut start = Vec::new();
    decoder.by_ref().take(16).read_to_end(&mut start)?;
    let format = Format::of(&start).ok_or_else(|| {
        invalid(match decoder.is_cut {
            true => format!("the zstd file is cut off after {packed} bytes, before a bag could be unpacked"),
            false => "compressed with zstd, but what is in it is no bag".to_owned(),
        })
    })?;
    let mut file = NamedTempFile::new()?;
    file.write_all(&start)?;
    io::copy(&mut decoder, &mut file)?;
    file.flush()?;
    let missing = decoder.is_cut.then(|| {
        let all = zstd::zstd_safe::get_frame_content_size(&bytes.start().unwrap_or_default()).ok().flatten();
        let of = all.map(|all| format!(" of {all}")).unwrap_or_default();
        format!(
            "the zstd file {name} is cut off after {packed} bytes: the first {}{of} bytes could be unpacked",
            decoder.count
        )
    });
    Ok((format, file, missing))
}

/// What we need of `metadata.yaml`.
#[derive(Deserialize)]
struct Metadata {
    rosbag2_bagfile_information: Information,
}

#[derive(Deserialize)]
struct Information {
    relative_file_paths: Vec<String>,
}

/// The files of a folder in their order, and a note if that was found out by their names.
pub(crate) fn in_folder(folder: &Path) -> Result<(Vec<BagFile>, Option<String>), LogError> {
    let metadata = folder.join("metadata.yaml");
    let io = |why| LogError::Io { file: metadata.display().to_string(), why };
    let text = match files::read_text(&metadata, MAX_METADATA) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return by_name(folder),
        Err(error) => return Err(io(error)),
    };
    let unusable = |why: String| LogError::Unusable { file: metadata.display().to_string(), why };
    let Metadata { rosbag2_bagfile_information: information } =
        serde_saphyr::from_str(&text).map_err(|error| {
            let text = error.to_string();
            let first = text.lines().next().unwrap_or_default();
            unusable(format!("{first}; without this file, the files of the folder are read by name"))
        })?;
    let mut files = Vec::new();
    let mut named = BTreeSet::new();
    for name in &information.relative_file_paths {
        if !named.insert(name) {
            return Err(unusable(format!("`{name}` is named twice")));
        }
        let relative = Path::new(name);
        if !relative.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
            return Err(unusable(format!("`{name}` is not a file of this folder")));
        }
        // Old versions wrote the name of the folder as well.
        let candidates = [folder.join(relative), folder.join(relative.file_name().unwrap_or_default())];
        let Some(path) = candidates.iter().find(|path| path.is_file()) else {
            return Err(unusable(format!("the file `{name}` is missing")));
        };
        let Some(file) = BagFile::open(path)? else {
            return Err(unusable(format!("`{name}` is neither MCAP nor SQLite")));
        };
        files.push(file);
    }
    if files.is_empty() {
        return Err(unusable("no file is named in `relative_file_paths`".to_owned()));
    }
    Ok((files, None))
}

/// All bag files of a folder without metadata, in the order of the numbers in their names.
fn by_name(folder: &Path) -> Result<(Vec<BagFile>, Option<String>), LogError> {
    let io = |why| LogError::Io { file: folder.display().to_string(), why };
    let entries = fs::read_dir(folder).and_then(Iterator::collect::<io::Result<Vec<_>>>).map_err(io)?;
    let mut paths: Vec<_> = entries.iter().map(DirEntry::path).filter(|path| path.is_file()).collect();
    paths.sort_by_key(|path| natural(&path.file_name().unwrap_or_default().to_string_lossy()));
    let mut files = Vec::new();
    for path in paths {
        files.extend(BagFile::open(&path)?);
    }
    if files.is_empty() {
        let why = "a folder without bag files".to_owned();
        return Err(LogError::Unusable { file: folder.display().to_string(), why });
    }
    let note =
        format!("metadata.yaml is missing: {} bag files are read in the order of their names", files.len());
    Ok((files, Some(note)))
}

/// A key that sorts `bag_10` after `bag_9`: text and numbers in turn.
fn natural(name: &str) -> Vec<(String, u64)> {
    let mut parts: Vec<(String, u64)> = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let text = rest.find(|at: char| at.is_ascii_digit()).unwrap_or(rest.len());
        let (text, after) = rest.split_at(text);
        let digits = after.find(|at: char| !at.is_ascii_digit()).unwrap_or(after.len());
        let (digits, after) = after.split_at(digits);
        parts.push((text.to_owned(), digits.parse().unwrap_or(u64::MAX)));
        rest = after;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names_are_in_order() {
        let mut names = ["bag_10.mcap", "bag_9.mcap", "a", "bag_1.mcap", "bag.mcap"];
        names.sort_by_key(|name| natural(name));
        assert_eq!(names, ["a", "bag.mcap", "bag_1.mcap", "bag_9.mcap", "bag_10.mcap"]);
    }
}

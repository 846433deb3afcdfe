//! The files in an archive, up to the first log.

use super::content::{Content, head};
use crate::bytes::Input;
use std::io::{self, Read};

/// The most files that are looked at, and the number of those that are named.
const MAX_FILES: usize = 10_000;
pub(super) const NAMED: usize = 5;

/// The name of a file whose name is no text.
const UNNAMED: &str = "?";

/// What was found in an archive.
#[derive(Debug, Default)]
pub(super) struct Listed {
    /// The first log: its name, and what it is.
    pub(super) log: Option<(String, Content)>,
    /// The names of the first files, and the number of files, up to the log.
    pub(super) names: Vec<String>,
    pub(super) files: usize,
}

impl Listed {
    /// Adds a file. Returns whether the search goes on.
    fn add(&mut self, name: &str, from: &mut impl Read) -> bool {
        self.files += 1;
        if self.names.len() < NAMED {
            self.names.push(name.to_owned());
        }
        let content = Content::unpacked(&head(from));
        if matches!(content, Content::Ros1 | Content::Ros2 | Content::Carmen) {
            self.log = Some((name.to_owned(), content));
        }
        self.log.is_none() && self.files < MAX_FILES
    }
}

/// The files in a zip archive.
pub(super) fn of_zip(file: Box<dyn Input>) -> io::Result<Listed> {
    let mut archive = zip::ZipArchive::new(file).map_err(io::Error::other)?;
    let mut listed = Listed::default();
    for number in 0..archive.len() {
        let name = archive.name_for_index(number).and_then(Result::ok);
        let name = name.map_or_else(|| UNNAMED.to_owned(), |name| name.into_owned());
        let goes_on = match archive.by_index(number) {
            Ok(entry) if entry.is_dir() => true,
            Ok(mut entry) => listed.add(&name, &mut entry),
            // What cannot be unpacked, as with a password, is known by its name alone.
            Err(_) => listed.add(&name, &mut io::empty()),
        };
        if !goes_on {
            break;
        }
    }
    Ok(listed)
}

/// The files in a tar archive.
pub(super) fn of_tar(file: impl Read) -> io::Result<Listed> {
    let mut archive = tar::Archive::new(file);
    let mut listed = Listed::default();
    for entry in archive.entries()? {
        let mut entry = entry?;
        if !entry.header().entry_type().is_file() {
            continue;
        }
        let name = String::from_utf8_lossy(&entry.path_bytes()).into_owned();
        if !listed.add(&name, &mut entry) {
            break;
        }
    }
    Ok(listed)
}

//! The error for a world or a tour that cannot be read.

use crate::files::{Disk, Files, MAX_TEXT_BYTES};
use crate::findings::{Finding, Findings};
use std::io;
use std::path::Path;

/// The errors of a world file or a tour that cannot be read or is invalid, in the order of the file.
///
/// `Display` prints all messages. Each message has several lines, without color, with the file, the line, the key,
/// what is invalid, and a valid value. The second and further messages begin with `error: `; the first one is
/// intended to be printed after `error: `.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", .0.error_text())]
pub struct WorldError(pub(crate) Findings);

impl WorldError {
    /// The errors, at least one: the first 20, and the number of all.
    pub fn findings(&self) -> &Findings {
        &self.0
    }
}

/// The name of a file in messages, and its text; `kind` is `world file` or `tour`.
pub(crate) fn read_text(kind: &str, path: &Path) -> Result<(String, String), WorldError> {
    let name = path.display().to_string();
    let not_text = |_| io::Error::new(io::ErrorKind::InvalidData, "it is not a text in UTF-8");
    let text = Disk.read(path, MAX_TEXT_BYTES).and_then(|bytes| String::from_utf8(bytes).map_err(not_text));
    let text = text.map_err(|error| {
        let what = format!("cannot read the {kind} `{name}`: {error}");
        WorldError(Findings::of_errors(vec![Finding::unreadable(&name, &what)], 0))
    });
    Ok((name, text?))
}

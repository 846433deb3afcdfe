//! What changes nothing here, in one note per file: so that what does change something stands out.

use super::sources::{Place, Sources};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use worldfile::Severity;

/// Of a name that stands in more lines, only the first are told.
const MOST_LINES: usize = 3;

/// The lines of names, by file.
#[derive(Default)]
pub(super) struct Harmless {
    lines: BTreeMap<u32, BTreeMap<String, BTreeSet<usize>>>,
}

impl Sources<'_> {
    /// Remembers that what is called `name` changes nothing.
    pub(super) fn harmless(&mut self, place: Place, name: &str) {
        let line = self.line(place);
        let names = self.harmless.lines.entry(place.file).or_default();
        names.entry(name.to_owned()).or_default().insert(line);
    }

    /// Tells everything that changes nothing.
    pub(super) fn tell_harmless(&mut self) {
        for (file, names) in std::mem::take(&mut self.harmless).lines {
            let names: Vec<String> = names.iter().map(|(name, lines)| with_lines(name, lines)).collect();
            let what = format!("these change nothing here: {}", names.join(", "));
            let help = "they say how Stage draws or runs a world, or are about what is not here; in ( ) are their lines";
            let path = self.path(Place { file, start: 0, end: 0 }).to_owned();
            self.findings.add_file(Severity::Note, Path::new(&path), &what, help);
        }
    }
}

/// As in `color (3, 8, 12, …)`.
fn with_lines(name: &str, lines: &BTreeSet<usize>) -> String {
    let first: Vec<String> = lines.iter().take(MOST_LINES).map(usize::to_string).collect();
    let more = if lines.len() > MOST_LINES { ", …" } else { "" };
    format!("`{name}` ({}{more})", first.join(", "))
}

//! What changes nothing here, in one note per file: so that what does change something stands out.

use std::collections::{BTreeMap, BTreeSet};

/// Of a name that stands in more lines, only the first are given.
const MOST_LINES: usize = 3;

/// The lines of names, by file.
#[derive(Default)]
pub(super) struct Harmless {
    lines: BTreeMap<u32, BTreeMap<String, BTreeSet<usize>>>,
}

impl Harmless {
    /// Remembers that what is called `name` in a line of a file changes nothing.
    pub(super) fn add(&mut self, file: u32, line: usize, name: &str) {
        let names = self.lines.entry(file).or_default();
        names.entry(name.to_owned()).or_default().insert(line);
    }

    /// The names of each file, with their lines.
    pub(super) fn take(&mut self) -> impl Iterator<Item = (u32, String)> + use<> {
        std::mem::take(&mut self.lines).into_iter().map(|(file, names)| {
            let names: Vec<String> = names.iter().map(|(name, lines)| with_lines(name, lines)).collect();
            (file, names.join(", "))
        })
    }
}

/// As in `color (3, 8, 12, …)`.
fn with_lines(name: &str, lines: &BTreeSet<usize>) -> String {
    let first: Vec<String> = lines.iter().take(MOST_LINES).map(usize::to_string).collect();
    let more = if lines.len() > MOST_LINES { ", …" } else { "" };
    format!("`{name}` ({}{more})", first.join(", "))
}

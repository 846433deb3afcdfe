//! The findings of a reader about a file: all errors, warnings and notes at once, each with its place.

mod source_text;

use annotate_snippets::Level;
use interfaces::printable;
pub(crate) use source_text::Mark;
pub use source_text::SourceText;
use std::collections::BTreeSet;
use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

/// The number of findings of each severity that are kept; further ones are only counted.
const MAX_KEPT: usize = 100;
/// The number of warnings with the same help that are kept, so that other warnings have room.
const MAX_ALIKE: usize = 10;
/// Texts of a message are cut after this, bytes: they can quote a value that is as long as its file.
const LONG_TEXT: usize = 2000;

/// The severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Information; nothing is invalid.
    Note,
    /// The world can be made, but a part of the file is ignored or replaced.
    Warning,
    /// The world cannot be made.
    Error,
}

/// A part of a file that is invalid, or that the reader ignores or replaces.
///
/// `Display` prints a message of several lines, without color, with the file and the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The severity of the finding.
    pub severity: Severity,
    /// The name of the file.
    pub file: String,
    /// The line, counted from 1; 0 means the whole file.
    pub line: usize,
    /// What is invalid.
    pub what: String,
    /// A valid value, or what is done instead.
    pub help: String,
    message: String,
}

impl Finding {
    fn new(severity: Severity, file: &str, line: usize, what: &str, help: &str) -> Self {
        let [file, what, help] = [file, what, help].map(shown);
        Self { severity, file, line, what, help, message: String::new() }
    }

    /// An error about a file that cannot be read.
    pub(crate) fn unreadable(file: &str, what: &str) -> Self {
        Self { message: format!("error: {}", shown(what)), ..Self::new(Severity::Error, file, 0, what, "") }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// A text as a message shows it: one printable line, not too long.
fn shown(text: &str) -> String {
    let end = text.floor_char_boundary(LONG_TEXT);
    let more = if end < text.len() { " …" } else { "" };
    format!("{}{more}", printable(&text[..end]))
}

impl Severity {
    const WORST_FIRST: [Self; 3] = [Self::Error, Self::Warning, Self::Note];

    fn level(self) -> Level<'static> {
        match self {
            Self::Error => Level::ERROR,
            Self::Warning => Level::WARNING,
            Self::Note => Level::NOTE,
        }
    }

    fn name(self) -> &'static str {
        ["note", "warning", "error"][self as usize]
    }
}

/// All findings of a reader: errors, then warnings, then notes, each in the order in which they were
/// made.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    kept: Vec<Finding>,
    /// The number of findings of each severity, from notes to errors, whether kept or not.
    counts: [usize; 3],
    /// The hash of each finding, whether kept or not: no finding is counted twice.
    made: BTreeSet<u64>,
}

impl Findings {
    /// These errors, and more that are only counted.
    pub(crate) fn of_errors(kept: Vec<Finding>, more: usize) -> Self {
        Self { counts: [0, 0, kept.len() + more], kept, made: BTreeSet::new() }
    }

    /// The findings that were kept: the first hundred of each severity, and the first ten warnings with the same
    /// help.
    pub fn iter(&self) -> impl Iterator<Item = &Finding> {
        self.kept.iter()
    }

    /// The number of errors, whether kept or not.
    pub fn errors(&self) -> usize {
        self.counts[Severity::Error as usize]
    }

    /// The number of warnings, whether kept or not.
    pub fn warnings(&self) -> usize {
        self.counts[Severity::Warning as usize]
    }

    /// The messages of one severity. If not all findings were kept, the last message has the number of the others.
    pub fn messages(&self, severity: Severity) -> Vec<String> {
        let kept = self.iter().filter(|finding| finding.severity == severity);
        let mut messages: Vec<String> = kept.map(ToString::to_string).collect();
        let left_out = self.counts[severity as usize] - messages.len();
        if left_out > 0 {
            let many = if left_out == 1 { "" } else { "s" };
            messages.push(format!("… and {left_out} more {}{many}", severity.name()));
        }
        messages
    }

    /// All errors as one text, to be printed after `error: `.
    pub fn error_text(&self) -> String {
        self.messages(Severity::Error).join("\n\n").trim_start_matches("error: ").to_owned()
    }

    /// Adds a finding about a place in a text. A finding that is repeated on the same line, as in a definition that
    /// is used often, is added once.
    pub fn add(&mut self, severity: Severity, source: &SourceText, what: &str, mark: Mark<'_>, help: &str) {
        let new = Finding::new(severity, &source.name, source.line_number(mark.0.start), what, help);
        self.keep(new, |_| source.report(severity, what, &mark, &[], help));
    }

    /// Adds a finding about a file as a whole.
    pub fn add_file(&mut self, severity: Severity, path: &Path, what: &str, help: &str) {
        let new = Finding::new(severity, &path.display().to_string(), 0, what, help);
        self.keep(new, |new| {
            format!("{}: {}: {}\n  = help: {}", severity.name(), new.file, new.what, new.help)
        });
    }

    fn keep(&mut self, new: Finding, message: impl FnOnce(&Finding) -> String) {
        let mut hasher = DefaultHasher::new();
        (new.line, &new.file, &new.what).hash(&mut hasher);
        if !self.made.insert(hasher.finish()) {
            return;
        }
        let alike = |old: &&Finding| (old.severity, &old.help) == (new.severity, &new.help);
        let is_one_of_many =
            new.severity == Severity::Warning && self.kept.iter().filter(alike).count() >= MAX_ALIKE;
        self.counts[new.severity as usize] += 1;
        let kept = self.kept.iter().filter(|old| old.severity == new.severity).count();
        if kept < MAX_KEPT && !is_one_of_many {
            let message = message(&new);
            let index = self.kept.partition_point(|old| old.severity >= new.severity);
            self.kept.insert(index, Finding { message, ..new });
        }
    }
}

impl fmt::Display for Findings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let messages = Severity::WORST_FIRST.map(|severity| self.messages(severity));
        f.write_str(&messages.concat().join("\n\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_alike_leave_room_for_others_and_are_counted() {
        let source = SourceText::new("x".into(), "\n".repeat(300).into_bytes());
        let mut findings = Findings::default();
        let mut add = |severity, what: &str, line: usize, help| {
            findings.add(severity, &source, what, (line..line, ""), help);
        };
        for line in 0..150 {
            add(Severity::Note, "seen", line, "");
            // Twice at one place is once.
            add(Severity::Warning, "odd", line, "as often");
            add(Severity::Warning, "odd", line, "as often");
        }
        add(Severity::Warning, "rare", 200, "and kept");
        add(Severity::Error, "bad", 201, "and first");
        let whats: Vec<&str> = findings.iter().map(|finding| finding.what.as_str()).collect();
        assert_eq!((whats.len(), whats[0], whats[10], whats[11]), (112, "bad", "odd", "rare"));
        assert_eq!((findings.errors(), findings.warnings()), (1, 151));
        assert_eq!(findings.messages(Severity::Warning).last().unwrap(), "… and 140 more warnings");
        assert!(findings.to_string().ends_with("\n\n… and 50 more notes"));
    }
}

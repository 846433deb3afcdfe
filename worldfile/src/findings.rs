//! What a reader has to say about a file: everything at once, each with its place.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::collections::BTreeSet;
use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;
use std::path::Path;

/// So many findings of each severity are kept; further ones are only counted.
const MOST_KEPT: usize = 100;
/// So many warnings of one kind are kept, so that they leave room for others.
const MOST_ALIKE: usize = 10;
/// Of a longer line only the part around the place is shown, in bytes.
const LONG_LINE: usize = 200;
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Nothing is wrong, but it is good to know.
    Note,
    /// The world can be made, but something in the file means nothing here, or not quite the same.
    Warning,
    /// The world cannot be made.
    Error,
}

/// One thing that is wrong with a file, or that the reader does otherwise than the file asks.
///
/// Its `Display` is a message of several lines, without colour, that names the file and the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// The file.
    pub file: String,
    /// The line, from 1 on; 0 stands for the file as a whole.
    pub line: usize,
    /// What is wrong.
    pub what: String,
    /// What would be right, or what is done instead.
    pub help: String,
    message: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
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
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }
}

/// All findings of a reader: errors, then warnings, then notes, each in the order in which they were
/// made.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    kept: Vec<Finding>,
    /// How many there are of each severity, from notes to errors, kept or not.
    counts: [usize; 3],
    /// What stands for each of them, kept or not: none is counted twice.
    made: BTreeSet<u64>,
}

impl Findings {
    /// The findings that were kept: the first hundred of each severity, and of warnings with the same
    /// help the first ten.
    pub fn iter(&self) -> impl Iterator<Item = &Finding> {
        self.kept.iter()
    }

    /// How many errors there are, kept or not.
    pub fn errors(&self) -> usize {
        self.counts[Severity::Error as usize]
    }

    /// How many warnings there are, kept or not.
    pub fn warnings(&self) -> usize {
        self.counts[Severity::Warning as usize]
    }

    /// The messages of one severity; the last one counts those that were not kept, if there are any.
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

    /// Adds a finding about a place in a text. The same finding at the same place, as in a
    /// definition that is used often, is made once.
    pub fn add(&mut self, severity: Severity, source: &SourceText, what: &str, mark: Mark<'_>, help: &str) {
        let (line, text, span) = source.line(&mark.0);
        let new = Finding {
            severity,
            file: source.name.clone(),
            line,
            what: what.to_owned(),
            help: help.to_owned(),
            message: String::new(),
        };
        self.keep(new, |_| {
            let snippet = Snippet::source(text).path(&source.name).line_start(line);
            let label = (!mark.1.is_empty()).then(|| mark.1.to_owned());
            let snippet = snippet.annotation(AnnotationKind::Primary.span(span).label(label));
            let report =
                [severity.level().primary_title(what).element(snippet).element(Level::HELP.message(help))];
            Renderer::plain().render(&report)
        });
    }

    /// Adds a finding about a file as a whole.
    pub fn add_file(&mut self, severity: Severity, path: &Path, what: &str, help: &str) {
        let file = path.display().to_string();
        let new = Finding {
            severity,
            file,
            line: 0,
            what: what.to_owned(),
            help: help.to_owned(),
            message: String::new(),
        };
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
            new.severity == Severity::Warning && self.kept.iter().filter(alike).count() >= MOST_ALIKE;
        self.counts[new.severity as usize] += 1;
        let kept = self.kept.iter().filter(|old| old.severity == new.severity).count();
        if kept < MOST_KEPT && !is_one_of_many {
            let message = message(&new);
            let place = self.kept.partition_point(|old| old.severity >= new.severity);
            self.kept.insert(place, Finding { message, ..new });
        }
    }
}

impl fmt::Display for Findings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let messages = Severity::WORST_FIRST.map(|severity| self.messages(severity));
        f.write_str(&messages.concat().join("\n\n"))
    }
}

/// A place in a text, as a range of bytes, with what is to be said of it.
pub(crate) type Mark<'a> = (Range<usize>, &'a str);

/// A text to point into.
#[derive(Clone, Debug)]
pub struct SourceText {
    /// What the file is called in messages.
    pub name: String,
    /// All of its text.
    pub text: String,
    /// Where its lines start.
    line_starts: Vec<usize>,
}

impl SourceText {
    /// The text of a file, as UTF-8 or, where it is none, as Latin-1: old files have accents in
    /// their comments. A mark of the byte order at the start, as some editors leave it, is no part of it.
    pub fn new(name: String, mut bytes: Vec<u8>) -> Self {
        if bytes.starts_with(BYTE_ORDER_MARK) {
            bytes.drain(..BYTE_ORDER_MARK.len());
        }
        let text = String::from_utf8(bytes)
            .unwrap_or_else(|error| error.into_bytes().into_iter().map(char::from).collect());
        let starts = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at + 1);
        let line_starts = std::iter::once(0).chain(starts).collect();
        Self { name, text, line_starts }
    }

    /// The number of the line where a place begins, from 1 on.
    pub fn line_number(&self, at: usize) -> usize {
        self.line_starts.partition_point(|start| *start <= at)
    }

    /// The part of a line from a column (both from 1 on, in characters) to its end.
    pub fn place(&self, line: usize, column: usize) -> Range<usize> {
        let whole = self.whole_line(line);
        let text = &self.text[whole.clone()];
        let skipped = text.char_indices().nth(column.saturating_sub(1)).map_or(text.len(), |(at, _)| at);
        let end = text.trim_end().len().max(skipped);
        whole.start + skipped..whole.start + end
    }

    /// A line, from 1 on, without its end.
    pub fn whole_line(&self, line: usize) -> Range<usize> {
        let line = line.clamp(1, self.line_starts.len());
        let end = self.line_starts.get(line).map_or(self.text.len(), |next| next - 1);
        self.line_starts[line - 1]..end
    }

    /// The line where a place begins: its number, its text, and the place in this text. Of a long
    /// line only a part.
    fn line(&self, place: &Range<usize>) -> (usize, &str, Range<usize>) {
        let number = self.line_number(place.start.min(self.text.len()));
        let Range { mut start, mut end } = self.whole_line(number);
        let from = place.start.clamp(start, end);
        let to = place.end.clamp(from, end);
        if end - start > LONG_LINE {
            start = self.text.floor_char_boundary(start.max(from.saturating_sub(LONG_LINE / 2)));
            end = self.text.ceil_char_boundary(end.min(from + LONG_LINE / 2));
        }
        let to = self.text.floor_char_boundary(to.min(end));
        let from = self.text.floor_char_boundary(from.min(to));
        (number, &self.text[start..end], from - start..to - start)
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
        add(Severity::Warning, "rare", 200, "but told");
        add(Severity::Error, "bad", 201, "and first");
        let whats: Vec<&str> = findings.iter().map(|finding| finding.what.as_str()).collect();
        assert_eq!((whats.len(), whats[0], whats[10], whats[11]), (112, "bad", "odd", "rare"));
        assert_eq!((findings.errors(), findings.warnings()), (1, 151));
        assert_eq!(findings.messages(Severity::Warning).last().unwrap(), "… and 140 more warnings");
        assert!(findings.to_string().ends_with("\n\n… and 50 more notes"));
    }
}

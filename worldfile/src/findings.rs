//! The findings of a reader about a file: all errors, warnings and notes at once, each with its place.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use interfaces::{printable, printable_lines};
use std::collections::BTreeSet;
use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;
use std::path::Path;

/// The number of findings of each severity that are kept; further ones are only counted.
const MAX_KEPT: usize = 100;
/// The number of warnings with the same help that are kept, so that other warnings have room.
const MAX_ALIKE: usize = 10;
/// If a line is longer, only the part around the place is shown, bytes.
const LONG_LINE: usize = 4000;
/// Texts of a message are cut after this, bytes: they can quote a value that is as long as its file.
const LONG_TEXT: usize = 2000;
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

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

/// A place in a text, as a range of bytes, and its label; the label can be empty.
pub(crate) type Mark<'a> = (Range<usize>, &'a str);

/// A text to point into.
#[derive(Clone, Debug)]
pub struct SourceText {
    /// The name of the file in messages.
    pub name: String,
    /// All of its text.
    pub text: String,
    /// Where its lines start.
    line_starts: Vec<usize>,
}

impl SourceText {
    /// The text of a file, as UTF-8 or, if it is not valid UTF-8, as Latin-1: old files have accents in
    /// their comments. A byte order mark at the start, as some editors write it, is left out.
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

    /// An error at `mark`; `others` are places that explain it, and `help` states what is valid.
    pub(crate) fn error(&self, what: &str, mark: &Mark<'_>, others: &[Mark<'_>], help: &str) -> Finding {
        let message = self.report(Severity::Error, what, mark, others, help);
        Finding {
            message,
            ..Finding::new(Severity::Error, &self.name, self.line_number(mark.0.start), what, help)
        }
    }

    fn report(
        &self,
        severity: Severity,
        what: &str,
        mark: &Mark<'_>,
        others: &[Mark<'_>],
        help: &str,
    ) -> String {
        let main = self.first_line(&mark.0);
        let spans: Vec<Range<usize>> = others.iter().map(|(span, _)| self.first_line(span)).collect();
        let all = || spans.iter().chain([&main]);
        let line = self.line_number(all().map(|span| span.start).min().unwrap_or_default());
        let last = self.line_number(all().map(|span| span.start).max().unwrap_or_default());
        // With the end of the line, at which a mark can be.
        let mut shown = self.whole_line(line).start..self.text.len().min(self.whole_line(last).end + 1);
        if line == last && shown.len() > LONG_LINE {
            let from = main.start.saturating_sub(LONG_LINE / 2).max(shown.start);
            let to = (main.start + LONG_LINE / 2).min(shown.end);
            shown = self.text.floor_char_boundary(from)..self.text.ceil_char_boundary(to);
        }
        let annotation = |kind: AnnotationKind, span: &Range<usize>, label: &str| {
            let [start, end] =
                [span.start, span.end].map(|at| at.clamp(shown.start, shown.end) - shown.start);
            kind.span(start..end).label((!label.is_empty()).then(|| self::shown(label)))
        };
        let context = spans.iter().zip(others);
        let snippet = Snippet::source(&self.text[shown.clone()])
            .line_start(line)
            .path(printable(&self.name))
            .annotation(annotation(AnnotationKind::Primary, &main, mark.1))
            .annotations(context.map(|(span, (_, label))| annotation(AnnotationKind::Context, span, label)));
        let title = severity.level().primary_title(self::shown(what));
        let help = Level::HELP.message(self::shown(help));
        // The renderer leaves some control characters of the source as they are.
        printable_lines(&Renderer::plain().render(&[title.element(snippet).element(help)])).into_owned()
    }

    /// The part of a span on its first line: a whole table would be underlined otherwise.
    fn first_line(&self, span: &Range<usize>) -> Range<usize> {
        let start = self.text.floor_char_boundary(span.start);
        let end = self.whole_line(self.line_number(start)).end;
        start..self.text.floor_char_boundary(span.end.min(end)).max(start)
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

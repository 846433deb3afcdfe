//! The text of a file, to point into.

use super::{Finding, Severity, shown};
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use interfaces::{printable, printable_lines};
use std::ops::Range;

/// If a line is longer, only the part around the place is shown, bytes.
const LONG_LINE: usize = 4000;
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

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
        let line = self.line_number(mark.0.start);
        Finding { message, ..Finding::new(Severity::Error, &self.name, line, what, help) }
    }

    pub(super) fn report(
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

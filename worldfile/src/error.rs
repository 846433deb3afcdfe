//! What is wrong with a world file, where, and what would be right.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::cell::OnceCell;
use std::ops::Range;

/// A world file that cannot be read or makes no sense.
///
/// Each of its messages has several lines, without colour, that name the file, the line, the key, what is
/// wrong and what would be right; the first in the file comes first. Its `Display` is all of them; the second
/// and further ones begin with `error: `, as whoever prints it begins the first.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", messages.join("\n\nerror: "))]
pub struct WorldError {
    messages: Vec<String>,
    /// The bytes of the text that they are about.
    places: Vec<usize>,
    /// How many more there are than messages, but for the last message, which says so.
    more: usize,
}

/// More than this are counted, but not told one by one: each message shows its lines of the file.
pub(crate) const MOST_TOLD: usize = 20;

/// Everything that is wrong with a file, as far as one thing being wrong does not hide another.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wrong {
    /// The messages, and the bytes of the text that they are about.
    found: Vec<(usize, String)>,
    /// How many more there are, all of them later in the file than [`MOST_TOLD`] that were found.
    more: usize,
}

impl Wrong {
    /// What was asked for, if it is right; else what is wrong is kept.
    pub(crate) fn keep<T>(&mut self, outcome: Result<T, WorldError>) -> Option<T> {
        outcome.map_err(|error| self.found.extend(error.places.into_iter().zip(error.messages))).ok()
    }

    /// Counts what is wrong as well, but is not to be told.
    pub(crate) fn and_more(&mut self, more: usize) {
        self.more += more;
    }

    /// Whether nothing was wrong so far.
    pub(crate) fn is_empty(&self) -> bool {
        self.count() == 0
    }

    /// How many things were wrong so far.
    pub(crate) fn count(&self) -> usize {
        self.found.len() + self.more
    }

    /// Everything that was wrong, as it was found; for whoever keeps it with the rest.
    pub(crate) fn into_part(self) -> WorldError {
        let (places, messages) = self.found.into_iter().unzip();
        WorldError { messages, places, more: 0 }
    }

    /// Everything that was wrong, the first in the file first; of a flood only how much more it was.
    pub(crate) fn into_error(mut self, source: &Source<'_>) -> WorldError {
        self.found.sort_by_key(|(place, _)| *place);
        let more = self.more + self.found.len().saturating_sub(MOST_TOLD);
        self.found.truncate(MOST_TOLD);
        if more > 0 {
            let many = if more == 1 { "" } else { "s" };
            self.found.push((usize::MAX, format!("{}: and {more} more error{many}", source.name)));
        }
        WorldError { more: more.saturating_sub(1), ..self.into_part() }
    }
}

/// The text of a world file, to point into.
pub(crate) struct Source<'a> {
    /// What the file is called in messages.
    pub(crate) name: &'a str,
    /// All of its text.
    pub(crate) text: &'a str,
    /// Where its lines end, once something is wrong: thousands of errors would count them thousands of times.
    line_ends: OnceCell<Vec<usize>>,
}

/// A place in the file that has a part in an error, with what is to be said of it.
pub(crate) type Mark<'a> = (Range<usize>, &'a str);

impl WorldError {
    /// What is wrong, one message each; at least one.
    pub fn messages(&self) -> &[String] {
        &self.messages
    }

    /// How many things are wrong: as many as there are messages, unless the last one counts further ones.
    pub fn count(&self) -> usize {
        self.messages.len() + self.more
    }

    /// A file that cannot be read at all; `kind`: `world file` or `tour`.
    pub(crate) fn unreadable(kind: &str, name: &str, error: &std::io::Error) -> Self {
        Self { messages: vec![format!("cannot read the {kind} `{name}`: {error}")], places: vec![0], more: 0 }
    }
}

impl<'a> Source<'a> {
    pub(crate) fn new(name: &'a str, text: &'a str) -> Self {
        Self { name, text, line_ends: OnceCell::new() }
    }

    /// An error at `mark`, with `others` that explain it and `help` that says what would be right.
    pub(crate) fn error(&self, what: &str, mark: Mark<'_>, others: &[Mark<'_>], help: &str) -> WorldError {
        // Only the lines that matter are looked at: a large file may have many errors.
        let spans = || std::iter::once(&mark).chain(others).map(|(span, _)| self.first_line(span));
        let first = spans().map(|span| span.start).min().unwrap_or_default();
        let last = spans().map(|span| span.end).max().unwrap_or_default();
        let start = self.text[..first].rfind('\n').map_or(0, |at| at + 1);
        let end = self.text[last..].find('\n').map_or(self.text.len(), |length| last + length + 1);
        let line_ends =
            self.line_ends.get_or_init(|| self.text.match_indices('\n').map(|(at, _)| at).collect());
        let line = 1 + line_ends.partition_point(|at| *at < start);
        let annotation = |kind: AnnotationKind, (span, label): &Mark<'_>| {
            let label = (!label.is_empty()).then(|| (*label).to_owned());
            let span = self.first_line(span);
            kind.span(span.start - start..span.end - start).label(label)
        };
        let snippet = Snippet::source(&self.text[start..end])
            .line_start(line)
            .path(self.name)
            .annotation(annotation(AnnotationKind::Primary, &mark))
            .annotations(others.iter().map(|other| annotation(AnnotationKind::Context, other)));
        let report =
            [Level::ERROR.no_name().primary_title(what).element(snippet).element(Level::HELP.message(help))];
        WorldError { messages: vec![Renderer::plain().render(&report)], places: vec![mark.0.start], more: 0 }
    }

    /// That the text is no TOML, in the same form as every other error.
    pub(crate) fn syntax_error(&self, error: &toml::de::Error) -> WorldError {
        let span = error.span().unwrap_or(0..0);
        if error.message().starts_with("duplicate key") {
            return self.error("a key is given twice", (span, "again here"), &[], "leave one of them out");
        }
        let (what, help) = match error.message().split_once(", expected ") {
            Some((what, expected)) => (what, format!("expected {expected}")),
            None => (error.message(), "see https://toml.io for how a TOML file is written".to_owned()),
        };
        self.error(&format!("not a TOML file: {what}"), (span, ""), &[], &help)
    }

    /// The part of a span on its first line: a whole table would be underlined otherwise.
    fn first_line(&self, span: &Range<usize>) -> Range<usize> {
        let start = self.text.floor_char_boundary(span.start);
        let end = self.text.floor_char_boundary(span.end).max(start);
        let line = self.text.get(start..end).and_then(|part| part.find('\n'));
        start..line.map_or(end, |length| start + length)
    }
}

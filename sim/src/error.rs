//! What is wrong with a world file, where, and what would be right.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::ops::Range;

/// A world file that cannot be read or makes no sense.
///
/// Each of its messages has several lines, without colour, that name the file, the line, the key, what is
/// wrong and what would be right. Its `Display` is all of them; the second and further ones begin with
/// `error: `, as whoever prints it begins the first.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", messages.join("\n\nerror: "))]
pub struct WorldError {
    messages: Vec<String>,
}

/// Everything that is wrong with a file, as far as one thing being wrong does not hide another.
#[derive(Debug, Default)]
pub(crate) struct Wrong {
    messages: Vec<String>,
}

impl Wrong {
    /// What was asked for, if it is right; else what is wrong is kept.
    pub(crate) fn keep<T>(&mut self, outcome: Result<T, WorldError>) -> Option<T> {
        outcome.map_err(|error| self.messages.extend(error.messages)).ok()
    }

    /// Whether nothing was wrong so far.
    pub(crate) fn is_empty(&self) -> bool {
        self.messages.is_empty()
    }

    /// Everything that was wrong.
    pub(crate) fn into_error(self) -> WorldError {
        WorldError { messages: self.messages }
    }
}

/// The text of a world file, to point into.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    /// What the file is called in messages.
    pub(crate) name: &'a str,
    /// All of its text.
    pub(crate) text: &'a str,
}

/// A place in the file that has a part in an error, with what is to be said of it.
pub(crate) type Mark<'a> = (Range<usize>, &'a str);

impl WorldError {
    /// What is wrong, one message each; at least one.
    pub fn messages(&self) -> &[String] {
        &self.messages
    }

    /// A file that could not be read at all.
    pub(crate) fn unreadable(name: &str, error: &std::io::Error) -> Self {
        Self { messages: vec![format!("cannot read the world file `{name}`: {error}")] }
    }
}

impl Source<'_> {
    /// An error at `mark`, with `others` that explain it and `help` that says what would be right.
    pub(crate) fn error(&self, what: &str, mark: Mark<'_>, others: &[Mark<'_>], help: &str) -> WorldError {
        let annotation = |kind: AnnotationKind, (span, label): &Mark<'_>| {
            let label = (!label.is_empty()).then(|| (*label).to_owned());
            kind.span(self.first_line(span)).label(label)
        };
        let snippet = Snippet::source(self.text)
            .path(self.name)
            .annotation(annotation(AnnotationKind::Primary, &mark))
            .annotations(others.iter().map(|other| annotation(AnnotationKind::Context, other)));
        let report =
            [Level::ERROR.no_name().primary_title(what).element(snippet).element(Level::HELP.message(help))];
        WorldError { messages: vec![Renderer::plain().render(&report)] }
    }

    /// What the TOML reader has to say, in the same form as every other error.
    pub(crate) fn toml_error(&self, mut error: toml::de::Error) -> WorldError {
        let span = error.span().unwrap_or(0..0);
        let said = error.message().to_owned();
        // Without a text to point into, the reader prints the path of the key instead.
        error.set_input(None);
        let place = error.to_string().lines().find_map(|line| line.strip_prefix("in `").map(str::to_owned));
        let key = place.map_or_else(String::new, |place| place.trim_end_matches('`').to_owned());
        let names = || said.split('`').skip(1).step_by(2);
        if said.starts_with("unknown field") {
            let unknown = names().next().unwrap_or_default();
            let known: Vec<&str> = names().skip(1).collect();
            let near = nearest(unknown, &known).map(|near| format!("did you mean `{near}`? "));
            let help = format!("{}the keys here are: {}", near.unwrap_or_default(), known.join(", "));
            return self.error(&format!("unknown key `{unknown}`"), (span, "not known here"), &[], &help);
        }
        if said.starts_with("missing field") {
            let missing = names().next().unwrap_or_default();
            let help = format!("add a line `{missing} = …` to this table");
            return self.error(
                &format!("the key `{missing}` is missing"),
                (span, "in this table"),
                &[],
                &help,
            );
        }
        let typed = ["invalid type: ", "invalid value: ", "invalid length "];
        if let Some((found, expected)) = said.split_once(", expected ")
            && let Some(found) = typed.iter().find_map(|start| found.strip_prefix(start))
        {
            let what = format!("`{key}` has the wrong type");
            let found = plain_value(found, said.starts_with("invalid length"));
            let help = format!("it must be {}", plain_type(expected, &key));
            return self.error(&what, (span, &format!("this is {found}")), &[], &help);
        }
        if said.starts_with("duplicate key") {
            return self.error("a key is given twice", (span, "again here"), &[], "leave one of them out");
        }
        let mut lines = said.splitn(2, ", expected ");
        let what = format!("not a TOML file: {}", lines.next().unwrap_or_default());
        let help = match lines.next() {
            Some(expected) => format!("expected {expected}"),
            None => "see https://toml.io for how a TOML file is written".to_owned(),
        };
        self.error(&what, (span, ""), &[], &help)
    }

    /// The part of a span on its first line: a whole table would be underlined otherwise.
    fn first_line(&self, span: &Range<usize>) -> Range<usize> {
        let start = span.start.min(self.text.len());
        let end = span.end.clamp(start, self.text.len());
        let line = self.text.get(start..end).and_then(|part| part.find('\n'));
        start..line.map_or(end, |length| start + length)
    }
}

/// What a newcomer calls the type that serde asks for.
fn plain_type(expected: &str, key: &str) -> String {
    let plain = match expected {
        "f64" | "a float" => "a number",
        "usize" | "u64" | "u32" => "a whole number of at least 0",
        "i64" => "a whole number",
        "a string" | "string" => "a text in quotes",
        "a sequence" if key.ends_with("_m") => "two numbers, as in `[1.0, 2.0]`",
        "a sequence" if key.ends_with("path") => "a list of cells, as in `[[1, 2], [5, 2]]`",
        "a sequence" => return format!("a list of tables, as in `[[{key}]]`"),
        "an array of length 2" => "two numbers, as in `[1.0, 2.0]`",
        other if other.starts_with("struct") || other == "a map" => "a table of keys",
        other => other,
    };
    plain.to_owned()
}

/// What a newcomer calls the value that serde has found.
fn plain_value(found: &str, is_length: bool) -> String {
    if is_length {
        return format!("a list of {found}");
    }
    if let Some(number) = found.strip_prefix("integer ").and_then(|number| number.strip_suffix(" as i128")) {
        return format!("the number {number}, which is too large");
    }
    let names = [
        ("floating point ", "the number "),
        ("integer ", "the number "),
        ("string ", "the text "),
        ("boolean ", ""),
        ("map", "a single table"),
        ("sequence", "a list"),
    ];
    let plain =
        names.iter().find_map(|(serde, plain)| Some(format!("{plain}{}", found.strip_prefix(serde)?)));
    plain.unwrap_or_else(|| found.to_owned())
}

/// The known key that is close enough to be what was meant.
fn nearest<'a>(unknown: &str, known: &[&'a str]) -> Option<&'a str> {
    let near = known.iter().map(|known| (edits(unknown, known), *known)).min()?;
    (near.0 <= 1 + unknown.chars().count() / 3).then_some(near.1)
}

/// Levenshtein's distance.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(row[j + 1] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_found_and_far_ones_are_not() {
        let known = ["radius_m", "heading_deg", "name"];
        assert_eq!(nearest("raduis_m", &known), Some("radius_m"));
        assert_eq!(nearest("heading", &known), None);
        assert_eq!(nearest("colour", &known), None);
        assert_eq!(edits("kitten", "sitting"), 3);
    }
}

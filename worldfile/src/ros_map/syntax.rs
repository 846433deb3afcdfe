//! What is invalid in a text that is not a list of keys with values, in other words than those of the parser, which
//! are about its settings and its types.

use super::EXAMPLE;
use crate::findings::SourceText;
use interfaces::is_printable;
use serde_saphyr::Error;

/// A fault of the text: its line, what it is, and what is valid.
pub(super) type Fault = (usize, &'static str, &'static str);

const TOO_MUCH: &str = "this file has too many values, or lists in too many others";
/// The maximum depth of lists in each other; the parser has a limit of its own, which is not below.
const MAX_DEPTH: usize = 50;
const LIST: &str = "a list is written as in `[-6.0, -6.0, 0.0]`";

/// The fault at which the parser has stopped.
pub(super) fn fault(source: &SourceText, error: &Error) -> Fault {
    let line = error.location().map_or(1, |at| at.line() as usize);
    let (what, help) = match error {
        Error::DuplicateMappingKey { .. } => ("a key is given twice", "leave one of them out"),
        Error::MultipleDocuments { .. } => {
            ("this file has more than one document", "a map is one document: leave `---` and the rest out")
        }
        Error::NullIntoString { .. } => ("a key without a name", EXAMPLE),
        Error::Budget { .. } => (TOO_MUCH, EXAMPLE),
        Error::UnknownAnchor { .. }
        | Error::AliasError { .. }
        | Error::AliasReplayLimitExceeded { .. }
        | Error::AliasExpansionLimitExceeded { .. }
        | Error::AliasReplayStackDepthExceeded { .. }
        | Error::RecursiveReferencesRequireWeakTypes { .. }
        | Error::MergeValueNotMapOrSeqOfMaps { .. } => (
            "a reference (`*name` or `<<`) to nothing, to itself or to too much",
            "write the value itself: a map needs no references",
        ),
        Error::Unexpected { .. } | Error::SerdeInvalidType { .. } => {
            ("this is not a list of keys with values", EXAMPLE)
        }
        _ => return in_text(&source.text).unwrap_or((line, "this line is not a key with a value", EXAMPLE)),
    };
    (line, what, help)
}

/// The first of the usual faults in a text that is not YAML; `None` if there is another one.
fn in_text(text: &str) -> Option<Fault> {
    let mut open: Vec<(usize, char)> = Vec::new();
    for (line, text) in (1..).zip(text.lines()) {
        let text = text.trim_end_matches('\r');
        if !text.chars().all(|character| character == '\t' || is_printable(character)) {
            return Some((line, "a character that is not text", EXAMPLE));
        }
        if text.trim_start_matches(' ').starts_with('\t') {
            return Some((
                line,
                "a tab at the start of a line",
                "lines may start with spaces, not with tabs",
            ));
        }
        let text = text.split(" #").next().unwrap_or_default();
        if text.starts_with('#') {
            continue;
        }
        let value = text.split_once(": ").map_or(text, |(_, value)| value).trim();
        if let Some(quote @ ('"' | '\'')) = value.chars().next()
            && (value.len() == 1 || !value.ends_with(quote))
        {
            return Some((
                line,
                "a text in quotes does not end",
                "end it with the quote that it begins with",
            ));
        }
        for bracket in text.chars() {
            match bracket {
                '[' | '{' if open.len() == MAX_DEPTH => return Some((line, TOO_MUCH, EXAMPLE)),
                '[' | '{' => open.push((line, bracket)),
                ']' | '}' => match open.pop() {
                    Some((_, '[')) if bracket == ']' => {}
                    Some((_, '{')) if bracket == '}' => {}
                    _ => return Some((line, "a list ends that did not begin", LIST)),
                },
                _ => {}
            }
        }
    }
    open.first().map(|(line, _)| (*line, "a list does not end", LIST))
}

//! What is wrong with the keys of a file and their types.

use crate::error::{MOST_TOLD, Source, WorldError, Wrong};
use serde_spanned::Spanned;
use std::cell::{Cell, RefCell};
use std::fmt;
use std::ops::Range;
use toml::de::{DeString, DeValue};

/// Everything that is wrong, as it is found.
#[derive(Default)]
pub(super) struct Faults {
    found: RefCell<Vec<Fault>>,
    /// For a stand-in whose need is known already.
    pub(super) ignored: Cell<bool>,
}

struct Fault {
    place: Range<usize>,
    is_at_root: bool,
    what: What,
}

enum What {
    Unknown { key: String, near: Option<&'static str>, known: &'static [&'static str] },
    Missing { key: &'static str },
    Mistyped { path: String, found: String, expected: String },
}

impl Faults {
    fn note(&self, place: Range<usize>, is_at_root: bool, what: What) {
        self.found.borrow_mut().push(Fault { place, is_at_root, what });
    }

    /// Notes a key that the table at `path` does not have; returns the one that it seems to mean.
    pub(super) fn unknown(
        &self,
        path: Path<'_>,
        key: &Spanned<DeString<'_>>,
        known: &'static [&'static str],
    ) -> Option<&'static str> {
        let near = nearest(key.get_ref(), known);
        let what = What::Unknown { key: key.get_ref().to_string(), near, known };
        self.note(key.span(), matches!(path, Path::Root), what);
        near
    }

    /// Notes a key that the table at `path`, which begins at `place`, must have.
    pub(super) fn missing(&self, path: Path<'_>, place: Range<usize>, key: &'static str) {
        self.note(place, matches!(path, Path::Root), What::Missing { key });
    }

    /// Notes a value of the wrong type.
    pub(super) fn mistyped(&self, path: Path<'_>, value: &Spanned<DeValue<'_>>, expected: &str) {
        let what = What::Mistyped {
            path: path.to_string(),
            found: plain_value(value.get_ref(), expected),
            expected: expected.to_owned(),
        };
        self.note(value.span(), matches!(path, Path::Key(Path::Root, _)), what);
    }

    pub(super) fn count(&self) -> usize {
        self.found.borrow().len()
    }

    pub(super) fn is_any_at_root(&self) -> bool {
        self.found.borrow().iter().any(|fault| fault.is_at_root)
    }

    /// The messages, the first in the file first; those that are too many to be told are counted.
    pub(super) fn told(self, source: &Source<'_>) -> Wrong {
        let mut faults = self.found.into_inner();
        faults.sort_by_key(|fault| fault.place.start);
        let mut wrong = Wrong::default();
        for fault in faults.iter().take(MOST_TOLD) {
            wrong.keep::<()>(Err(fault.told(source)));
        }
        wrong.and_more(faults.len().saturating_sub(MOST_TOLD));
        wrong
    }
}

impl Fault {
    fn told(&self, source: &Source<'_>) -> WorldError {
        let (what, label, help) = match &self.what {
            What::Unknown { key, near, known } => {
                let near = near.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
                let help = format!("{near}the keys here are: {}", known.join(", "));
                (format!("unknown key `{key}`"), "not known here".to_owned(), help)
            }
            What::Missing { key } => {
                let help = format!("add a line `{key} = …` to this table");
                (format!("the key `{key}` is missing"), "in this table".to_owned(), help)
            }
            What::Mistyped { path, found, expected } => (
                format!("`{path}` has the wrong type"),
                format!("this is {found}"),
                format!("it must be {expected}"),
            ),
        };
        source.error(&what, (self.place.clone(), &label), &[], &help)
    }
}

/// Where a value stands, as in `robot.laser.beams`.
#[derive(Clone, Copy)]
pub(super) enum Path<'a> {
    Root,
    Key(&'a Path<'a>, &'static str),
}

impl Path<'_> {
    /// What a list at this place is a list of.
    pub(super) fn list(&self) -> String {
        match self {
            Self::Key(_, key) if key.ends_with("_m") => {
                "a list of points, as in `[[1.0, 2.0], [3.0, 2.0]]`".to_owned()
            }
            Self::Key(_, key) if key.ends_with("_s") => "a list of numbers, as in `[1.0, 2.0]`".to_owned(),
            Self::Key(_, "path") => "a list of cells, as in `[[1, 2], [5, 2]]`".to_owned(),
            _ => format!("a list of tables, as in `[[{self}]]`"),
        }
    }
}

impl fmt::Display for Path<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Root => Ok(()),
            Self::Key(Path::Root, key) => f.write_str(key),
            Self::Key(table, key) => write!(f, "{table}.{key}"),
        }
    }
}

/// What a newcomer calls the value.
fn plain_value(value: &DeValue<'_>, expected: &str) -> String {
    let is_number = expected.contains("number");
    match value {
        DeValue::String(text) => format!("the text {text:?}"),
        DeValue::Integer(number) if is_number && !number.as_str().starts_with('-') => {
            format!("the number `{number}`, which is too large")
        }
        DeValue::Integer(number) => format!("the number `{number}`"),
        DeValue::Float(number) if expected == "a number" => {
            format!("the number `{number}`, which is too large")
        }
        DeValue::Float(number) => format!("the number `{number}`"),
        DeValue::Boolean(truth) => format!("`{truth}`"),
        DeValue::Datetime(_) => "a date or a time".to_owned(),
        DeValue::Array(list) if expected.starts_with("two") => format!("a list of {}", list.len()),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a single table".to_owned(),
    }
}

/// The known key that is close enough to be what was meant.
fn nearest<'a>(unknown: &str, known: &[&'a str]) -> Option<&'a str> {
    let length = unknown.chars().count();
    let most = 1 + length / 3;
    // It takes an edit for every character that one is longer: a key of a megabyte is near to none.
    let known = known.iter().filter(|known| known.len().abs_diff(length) <= most);
    let near = known.map(|known| (edits(unknown, known), known.len().abs_diff(length), *known)).min()?;
    (near.0 <= most).then_some(near.2)
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
        assert_eq!(nearest("nmae", &["map", "name"]), Some("name"));
        assert_eq!(nearest("heading", &known), None);
        assert_eq!(nearest("colour", &known), None);
        assert_eq!(edits("kitten", "sitting"), 3);
    }
}

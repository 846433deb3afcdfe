//! Reads a TOML file table by table and reports everything that is invalid at once.
//!
//! The caller asks for tables and values by key, with their type and range. If one is invalid, the error is
//! recorded and the answer is `None`. The caller continues with the rest, so that one error does not hide another,
//! and does not judge anything by a missing value, so that one error does not cause another. A table is opened with
//! the list of its keys: an unknown key may be a misspelling of a key that then seems to be missing.

mod spelling;
#[cfg(test)]
pub(crate) mod tests;
mod value;

use crate::error::WorldError;
use crate::findings::{Findings, Mark, SourceText};
use interfaces::is_printable;
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};
pub(crate) use value::{Figure, Value, extent, valid};

/// The number of errors that are shown; further errors are only counted.
const MAX_SHOWN: usize = 20;

/// The number of errors after which no key is looked up for an unknown one.
const MAX_JUDGED: usize = 1000;

/// The kinds of files: two kinds of worlds, and tours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Grid,
    Physics,
    Tour,
}

/// A file that is being read.
pub(crate) struct File<'a> {
    source: &'a SourceText,
    errors: RefCell<Vec<FileError>>,
}

/// An error before it is rendered: of many, only the first in the file are.
struct FileError {
    what: String,
    mark: (Range<usize>, String),
    others: Vec<(Range<usize>, String)>,
    help: String,
}

/// Reads a file: `build` makes the result from the root table, which has the keys `keys`.
///
/// # Errors
///
/// When the text is not TOML, describes a world of the other kind, or anything was recorded as invalid.
pub(crate) fn read<T>(
    name: &str,
    text: &str,
    kind: Kind,
    keys: &'static str,
    build: impl FnOnce(&Table<'_>) -> Option<T>,
) -> Result<T, WorldError> {
    let source = SourceText::new(name.to_owned(), text.into());
    let file = File { source: &source, errors: RefCell::default() };
    let value = match DeTable::parse(&source.text) {
        Err(error) => file.syntax_error(&error),
        Ok(root) if file.is_of_kind(kind, root.get_ref()) => {
            build(&Table::open(&file, String::new(), keys, Some(root.get_ref()), root.span()))
        }
        Ok(_) => None,
    };
    value.filter(|_| file.is_sound()).ok_or_else(|| WorldError(file.findings()))
}

impl File<'_> {
    /// Records an error at `mark`; `others` are places that explain it, and `help` states what is valid.
    pub(crate) fn error<T>(&self, what: &str, mark: Mark<'_>, others: &[Mark<'_>], help: &str) -> Option<T> {
        let owned = |(span, label): &Mark<'_>| (span.clone(), (*label).to_owned());
        self.errors.borrow_mut().push(FileError {
            what: what.to_owned(),
            mark: owned(&mark),
            others: others.iter().map(owned).collect(),
            help: help.to_owned(),
        });
        None
    }

    /// Whether nothing was invalid so far.
    pub(crate) fn is_sound(&self) -> bool {
        self.errors.borrow().is_empty()
    }

    /// The path of a file that this file names.
    pub(crate) fn beside(&self, name: &str) -> PathBuf {
        Path::new(&self.source.name).parent().unwrap_or(Path::new("")).join(name)
    }

    /// The text at a place.
    pub(crate) fn text(&self, place: Range<usize>) -> &str {
        self.source.text.get(place).unwrap_or_default()
    }

    /// The errors in the order of the file.
    fn findings(&self) -> Findings {
        let mut errors = self.errors.take();
        errors.sort_by_key(|error| error.mark.0.start);
        let shown = errors.iter().take(MAX_SHOWN).map(|FileError { what, mark, others, help }| {
            let others: Vec<Mark<'_>> = others.iter().map(|(span, label)| (span.clone(), &**label)).collect();
            self.source.error(what, &(mark.0.clone(), &mark.1), &others, help)
        });
        Findings::of_errors(shown.collect(), errors.len().saturating_sub(MAX_SHOWN))
    }

    fn syntax_error<T>(&self, error: &toml::de::Error) -> Option<T> {
        let what = format!("this is not valid TOML: {}", error.message());
        let help = "a value is written as in `a = 0.5`, `a = \"text\"`, `a = true` or `a = [1.0, 2.0]`, the header of a \
                    table as in `[map]` or `[[robot]]`";
        self.error(&what, (error.span().unwrap_or(0..0), ""), &[], help)
    }

    /// Whether the file does not describe a world of the other kind: `map` is a drawing, or a table of sizes.
    fn is_of_kind(&self, kind: Kind, root: &DeTable<'_>) -> bool {
        let Some((key, value)) = root.get_key_value("map") else { return true };
        let (what, label, help) = match (kind, value.get_ref()) {
            (Kind::Grid, DeValue::Table(_)) => (
                "this is a physics world, not a grid world",
                "sizes, not a drawing",
                "a grid world draws its `map` as text: `#` wall, `.` free, one row of text per row of cells",
            ),
            (Kind::Physics, DeValue::String(_)) => (
                "this is a grid world, not a physics world",
                "a drawing, not sizes",
                "a physics world has a table `[map]` with `size_m` and `cell_m`",
            ),
            _ => return true,
        };
        self.error(what, (key.span(), label), &[], help).unwrap_or(false)
    }
}

/// A table of the file.
pub(crate) struct Table<'a> {
    pub(crate) file: &'a File<'a>,
    /// The path of the table, for example `robot.laser`; empty for the root.
    path: String,
    /// The valid keys, separated by `, `.
    keys: &'static str,
    /// The value of the table; `None` if it is left out.
    entries: Option<&'a DeTable<'a>>,
    /// The place in the file; for a table with a header, the place of the header.
    pub(crate) span: Range<usize>,
    has_only_known_keys: bool,
    /// Whether no number that was read is invalid.
    is_valid: Cell<bool>,
    /// The keys that unknown keys seem to mean: they are not missing as well.
    meant: Vec<&'static str>,
}

impl<'a> Table<'a> {
    /// Records every unknown key.
    fn open(
        file: &'a File<'a>,
        path: String,
        keys: &'static str,
        entries: Option<&'a DeTable<'a>>,
        span: Range<usize>,
    ) -> Self {
        let mut table = Self {
            file,
            path,
            keys,
            entries,
            span,
            has_only_known_keys: true,
            is_valid: Cell::new(true),
            meant: Vec::new(),
        };
        for (key, _) in entries.into_iter().flatten().filter(|(key, _)| !has(keys, key.get_ref())) {
            let is_judged = file.errors.borrow().len() < MAX_JUDGED;
            let near = is_judged.then(|| spelling::nearest(key.get_ref(), keys.split(", "))).flatten();
            let hint = near.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
            let help = format!("{hint}the keys here are: {keys}");
            let what = format!("unknown key `{}`", key.get_ref());
            file.error::<()>(&what, (key.span(), "not known here"), &[], &help);
            table.has_only_known_keys = false;
            table.meant.extend(near);
        }
        table
    }

    /// The value, unless a number is invalid, or the table has unknown keys: what they mean is missing in it.
    pub(crate) fn sound<T>(&self, value: T) -> Option<T> {
        (self.has_only_known_keys && self.is_valid.get()).then_some(value)
    }

    /// Records an error about the meaning of the table, unless the error could be due to an unknown key.
    pub(crate) fn error<T>(&self, what: &str, mark: Mark<'_>, others: &[Mark<'_>], help: &str) -> Option<T> {
        self.has_only_known_keys.then_some(())?;
        self.file.error(what, mark, others, help)
    }

    /// The value of a key, if it is given.
    pub(crate) fn get<'t>(&'t self, key: &'static str) -> Option<Value<'t, 'a>> {
        debug_assert!(has(self.keys, key), "`{key}` is not in the list of keys");
        Some(Value { table: self, key, found: self.entries?.get(key)? })
    }

    /// The value of a key, which must be given.
    pub(crate) fn needed<'t>(&'t self, key: &'static str) -> Option<Value<'t, 'a>> {
        let value = self.get(key);
        if value.is_none() && !self.meant.contains(&key) {
            let help = format!("add a line `{key} = …` to this table");
            let what = format!("the key `{key}` is missing");
            self.file.error::<()>(&what, (self.span.clone(), "in this table"), &[], &help);
        }
        value
    }

    /// Whether a key is given.
    pub(crate) fn has(&self, key: &'static str) -> bool {
        self.get(key).is_some()
    }

    /// Records an error if the table of a thing has both a key and one of the `others`.
    pub(crate) fn has_none_of(&self, others: &[&'static str], key: &'static str, name: &str) -> Option<()> {
        let Some(other) = others.iter().find(|other| self.has(other)) else { return Some(()) };
        let what = format!("`{name}` has both `{key}` and `{other}`");
        let mark = (self.at(other), "and this");
        self.error(&what, mark, &[(self.at(key), "this one")], "leave one of them out")
    }

    /// The keys that are given, with the places of their values.
    pub(crate) fn given(&self) -> impl Iterator<Item = (&str, Range<usize>)> {
        let given = |key| Some((key, self.entries?.get(key)?.span()));
        self.keys.split(", ").filter_map(given)
    }

    /// The place of the value of a key; of the table if it is not given.
    pub(crate) fn at(&self, key: &'static str) -> Range<usize> {
        self.get(key).map_or(self.span.clone(), |value| value.found.span())
    }

    /// The place of an item of the list that a key has; of the table if there is none.
    pub(crate) fn at_item(&self, key: &'static str, index: usize) -> Range<usize> {
        let item = self.get(key).and_then(|value| Some(value.found.get_ref().as_array()?.get(index)?.span()));
        item.unwrap_or(self.span.clone())
    }

    /// The path of a key, as in `robot.laser.beams`.
    pub(crate) fn path(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// The table that a key has; it must be given.
    pub(crate) fn table(&self, key: &'static str, keys: &'static str) -> Option<Table<'a>> {
        self.needed(key)?.table(keys)
    }

    /// The table that a key has, or a table without keys.
    pub(crate) fn table_or_empty(&self, key: &'static str, keys: &'static str) -> Option<Table<'a>> {
        match self.get(key) {
            Some(value) => value.table(keys),
            None => Some(Self::open(self.file, self.path(key), keys, None, self.span.clone())),
        }
    }

    /// The tables of a list, as in `[[wall]]`; none if it is not given. A longer list than [`most_tables`] is an
    /// error, and none of it is read.
    pub(crate) fn tables(&self, key: &'static str, keys: &'static str) -> Vec<Table<'a>> {
        let items = self.get(key).and_then(|value| value.items()).unwrap_or_default();
        let most = most_tables(key);
        if let Some(first) = items.get(most) {
            let what = format!("there are {} tables `[[{}]]`", items.len(), self.path(key));
            let help =
                format!("{most} are the most; walls can be drawn in the picture of a `[[floor_plan]]`");
            self.file.error::<()>(&what, (first.found.span(), "one too many"), &[], &help);
            return Vec::new();
        }
        items.into_iter().filter_map(|item| item.table(keys)).collect()
    }

    /// The name in the table: printable, and not empty.
    pub(crate) fn name(&self) -> Option<String> {
        let name = self.needed("name")?.text()?;
        if name.trim().is_empty() {
            let what = format!("`{}` is empty", self.path("name"));
            let help = "give it a name, as in `name = \"curious\"`";
            return self.file.error(&what, (self.at("name"), "empty"), &[], help);
        }
        // They would forge lines of a report, or reach the terminal.
        if !name.chars().all(is_printable) {
            let what = format!("`{}` has a character that is not printable", self.path("name"));
            let help = "a name is one line of printable text";
            return self.file.error(&what, (self.at("name"), "not printable"), &[], help);
        }
        Some(name.to_owned())
    }
}

/// The maximum number of tables in a list. What can move is compared with everything else.
fn most_tables(key: &str) -> usize {
    match key {
        "wall" => 100_000,
        "sonar" => 100, // of a robot
        _ => 10_000,
    }
}

/// Whether a list of keys has this key.
pub(crate) fn has(keys: &str, key: &str) -> bool {
    keys.split(", ").any(|known| known == key)
}

/// Notes every name that a table shares with an earlier one; `kind`: what the tables describe.
pub(crate) fn unique_names(kind: &str, tables: &[Table<'_>]) {
    let mut seen = BTreeMap::new();
    for table in tables {
        let name = table.get("name").and_then(|name| name.found.get_ref().as_str());
        let Some((name, first)) = name.and_then(|name| Some((name, seen.insert(name, table.at("name"))?)))
        else {
            continue;
        };
        let what = format!("two {kind}s are called `{name}`");
        let help = format!("every {kind} needs a name of its own");
        table.error::<()>(&what, (table.at("name"), "again here"), &[(first, "first here")], &help);
    }
}

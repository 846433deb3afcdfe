//! The texts that make up a world: the file itself and what it includes.

use super::lexer::{self, Kind, Span, Token};
use interfaces::printable;
use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};
use worldfile::{Files, Findings, Severity, SourceText};

/// The maximum length of all texts together; an include in an include in an include would exceed any.
const MAX_BYTES: u64 = 8 << 20;
/// The number of errors after which no more includes are read.
const MAX_ERRORS: usize = 100;
/// The maximum depth of includes in each other.
const MAX_DEPTH: usize = 32;
/// For a name without effect that occurs in several lines, the number of lines that are listed.
const MAX_LINES: usize = 3;

/// All texts read so far, and the findings about them.
pub(super) struct Sources<'a> {
    pub(super) files: &'a dyn Files,
    texts: Vec<SourceText>,
    paths: Vec<PathBuf>,
    /// The file that is read and those that include it.
    open: Vec<PathBuf>,
    tokens: Vec<Token>,
    /// The number of bytes that may still be read.
    bytes_left: u64,
    /// Whether something could not be included: what is not defined is no error then.
    pub(super) is_incomplete: bool,
    /// The lines of the names that change nothing, by file and name.
    no_effect: BTreeMap<u32, BTreeMap<String, BTreeSet<usize>>>,
    pub(super) findings: Findings,
}

impl<'a> Sources<'a> {
    pub(super) fn new(files: &'a dyn Files) -> Self {
        Self {
            files,
            texts: Vec::new(),
            paths: Vec::new(),
            open: Vec::new(),
            tokens: Vec::new(),
            bytes_left: MAX_BYTES,
            is_incomplete: false,
            no_effect: BTreeMap::new(),
            findings: Findings::default(),
        }
    }

    /// The tokens of a file, with those of all files that it includes in their places, as far as these
    /// can be read; `None` if the file itself cannot.
    pub(super) fn read(&mut self, path: &Path) -> Option<Vec<Token>> {
        match self.files.read(path, self.bytes_left) {
            Ok(bytes) => self.append(path, bytes).then(|| std::mem::take(&mut self.tokens)),
            Err(error) => {
                let help = "a world file is a text, and it and all that it includes has at most 8 MiB";
                let what = format!("cannot read this file: {error}");
                self.findings.add_file(Severity::Error, path, &what, help);
                None
            }
        }
    }

    /// Appends the tokens of a text; false if it cannot be read as such.
    fn append(&mut self, path: &Path, bytes: Vec<u8>) -> bool {
        self.bytes_left -= bytes.len() as u64;
        let file = self.texts.len() as u32;
        self.texts.push(SourceText::new(printable(&path.display().to_string()).into_owned(), bytes));
        self.paths.push(path.to_owned());
        let own = match lexer::tokens(&self.texts[file as usize].text, file) {
            Ok(own) => own,
            Err((place, what, help)) => {
                self.error(place, what, help);
                return false;
            }
        };
        self.open.push(path.to_owned());
        let mut own = own.into_iter().peekable();
        while let Some(token) = own.next() {
            if self.is_incomplete && self.findings.errors() >= MAX_ERRORS {
                break;
            }
            let is_include = token.kind == Kind::Word && self.text(token.place) == "include";
            if !is_include {
                self.tokens.push(token);
                continue;
            }
            let is_read = match own.next_if(|next| next.kind == Kind::Text) {
                Some(name) => self.include(path, name.place),
                None => {
                    let help = "write the name of a file after it, as in `include \"robots.inc\"`";
                    self.error(token.place, "an include without a file", help);
                    own.next_if(|next| next.kind == Kind::Word);
                    false
                }
            };
            self.is_incomplete |= !is_read;
        }
        self.open.pop();
        true
    }

    fn include(&mut self, from: &Path, name: Span) -> bool {
        // Stage looks in the folder of the world file, whatever file the include is in.
        let (mut path, second) = (self.beside(self.path(), name), self.beside(from, name));
        let mut bytes = self.files.read(&path, self.bytes_left);
        if second != path && bytes.as_ref().is_err_and(|error| error.kind() == ErrorKind::NotFound) {
            bytes = self.files.read(&second, self.bytes_left);
            path = second;
        }
        let is_circle = self.open.contains(&path);
        if is_circle || self.open.len() >= MAX_DEPTH {
            let what = format!("`{}` includes itself", path.display());
            let what = if is_circle { &what } else { "too many includes in each other" };
            let (mark, help) = ((name.range(), "this leads back here"), "leave one of the includes out");
            self.findings.add(Severity::Error, &self.texts[name.file as usize], what, mark, help);
            return false;
        }
        match bytes {
            Ok(bytes) => self.append(&path, bytes),
            Err(error) => {
                let help = "included files are looked for beside the world file, then beside the file that includes them";
                self.error(name, format!("cannot read `{}`: {error}", path.display()), help);
                false
            }
        }
    }

    /// The path of a file that is named in the file `from`.
    pub(super) fn beside(&self, from: &Path, name: Span) -> PathBuf {
        // Not by the disk: `a/../b` is `b` here, so that a file has one name.
        let mut path = from.parent().unwrap_or(Path::new("")).to_owned();
        for part in Path::new(self.text(name)).components() {
            match part {
                Component::CurDir => {}
                Component::ParentDir if path.file_name().is_some() => {
                    path.pop();
                }
                other => path.push(other),
            }
        }
        path
    }

    /// The path of the world file.
    pub(super) fn path(&self) -> &Path {
        &self.paths[0]
    }

    /// The text at a place.
    pub(super) fn text(&self, place: Span) -> &str {
        self.texts[place.file as usize].text.get(place.range()).unwrap_or_default()
    }

    /// The file and line of a place, as in `cave.world:12`.
    pub(super) fn name(&self, place: Span) -> String {
        let text = &self.texts[place.file as usize];
        format!("{}:{}", text.name, text.line_number(place.start as usize))
    }

    /// The files, by their names in messages.
    pub(super) fn file_names(&self) -> Vec<String> {
        self.texts.iter().map(|text| text.name.clone()).collect()
    }

    /// Remembers that `name` at this place changes nothing.
    pub(super) fn has_no_effect(&mut self, place: Span, name: &str) {
        let line = self.texts[place.file as usize].line_number(place.start as usize);
        let names = self.no_effect.entry(place.file).or_default();
        names.entry(name.to_owned()).or_default().insert(line);
    }

    /// Adds one note per file of all that changes nothing, so that other findings are not lost among them.
    pub(super) fn note_no_effect(&mut self) {
        let help =
            "they say how Stage draws or runs a world, or are about what is not here; in ( ) are their lines";
        for (file, names) in std::mem::take(&mut self.no_effect) {
            let names = names.iter().map(|(name, lines)| {
                let first: Vec<String> = lines.iter().take(MAX_LINES).map(usize::to_string).collect();
                let more = if lines.len() > MAX_LINES { ", …" } else { "" };
                format!("`{name}` ({}{more})", first.join(", "))
            });
            let what = format!("these change nothing here: {}", names.collect::<Vec<_>>().join(", "));
            self.findings.add_file(Severity::Note, &self.paths[file as usize], &what, help);
        }
    }

    pub(super) fn error(&mut self, place: Span, what: impl AsRef<str>, help: impl AsRef<str>) {
        self.add(Severity::Error, place, what, help);
    }

    pub(super) fn warning(&mut self, place: Span, what: impl AsRef<str>, help: impl AsRef<str>) {
        self.add(Severity::Warning, place, what, help);
    }

    pub(super) fn add(&mut self, how: Severity, place: Span, what: impl AsRef<str>, help: impl AsRef<str>) {
        let text = &self.texts[place.file as usize];
        self.findings.add(how, text, what.as_ref(), (place.range(), ""), help.as_ref());
    }

    /// Adds a finding about the world file as a whole.
    pub(super) fn add_file(&mut self, how: Severity, what: impl AsRef<str>, help: impl AsRef<str>) {
        self.findings.add_file(how, &self.paths[0], what.as_ref(), help.as_ref());
    }
}

//! The texts that make up a world: the file itself and what it includes.

use super::harmless::Harmless;
use super::lexer::{self, Kind, Token};
use super::place::Place;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use worldfile::Files;
use worldfile::{Findings, Severity, SourceText};

/// All texts together may not be longer; an include in an include in an include would be.
const MAX_BYTES: u64 = 8 << 20;
/// The number of errors after which no more includes are read.
const MAX_ERRORS: usize = 100;
/// Includes may not lie deeper in each other.
const MAX_DEPTH: usize = 32;

/// All texts read so far, and what there is to say about them.
pub(super) struct Sources<'a> {
    files: &'a dyn Files,
    texts: Vec<SourceText>,
    paths: Vec<PathBuf>,
    /// How many bytes may still be read.
    bytes_left: u64,
    /// Whether something could not be included: what is not defined is no error then.
    pub(super) is_incomplete: bool,
    pub(super) harmless: Harmless,
    pub(super) findings: Findings,
}

impl<'a> Sources<'a> {
    pub(super) fn new(files: &'a dyn Files) -> Self {
        Self {
            files,
            texts: Vec::new(),
            paths: Vec::new(),
            bytes_left: MAX_BYTES,
            is_incomplete: false,
            harmless: Harmless::default(),
            findings: Findings::default(),
        }
    }

    /// The tokens of a file, with those of all files that it includes in their places, as far as these
    /// can be read; `None` if the file itself cannot.
    pub(super) fn read(&mut self, path: &Path) -> Option<Vec<Token>> {
        let bytes = match self.files.read(path, self.bytes_left) {
            Ok(bytes) => bytes,
            Err(error) => {
                let help = "a world file is a text, and it and all that it includes has at most 8 MiB";
                let what = format!("cannot read this file: {error}");
                self.findings.add_file(Severity::Error, path, &what, help);
                return None;
            }
        };
        let mut tokens = Vec::new();
        self.append(path, bytes, &mut Vec::new(), &mut tokens).then_some(tokens)
    }

    /// Appends the tokens of a text, unless it cannot be read as such. `open`: the files that include it.
    fn append(
        &mut self,
        path: &Path,
        bytes: Vec<u8>,
        open: &mut Vec<PathBuf>,
        tokens: &mut Vec<Token>,
    ) -> bool {
        self.bytes_left -= bytes.len() as u64;
        let file = self.texts.len() as u32;
        self.texts.push(SourceText::new(path.display().to_string(), bytes));
        self.paths.push(path.to_owned());
        let own = match lexer::tokens(&self.texts[file as usize].text, file) {
            Ok(own) => own,
            Err(error) => {
                self.error(error.place, error.what, "", error.help);
                return false;
            }
        };
        open.push(path.to_owned());
        let mut own = own.into_iter().peekable();
        while let Some(token) = own.next() {
            if self.is_incomplete && self.findings.errors() >= MAX_ERRORS {
                break;
            }
            let is_include = token.kind == Kind::Word && self.text(token.place) == "include";
            if !is_include {
                tokens.push(token);
                continue;
            }
            match own.next_if(|next| next.kind == Kind::Text) {
                Some(name) => self.is_incomplete |= !self.include(path, name.place, open, tokens),
                None => {
                    let help = "write the name of a file after it, as in `include \"robots.inc\"`";
                    self.error(token.place, "an include without a file", "", help);
                    own.next_if(|next| next.kind == Kind::Word);
                    self.is_incomplete = true;
                }
            }
        }
        open.pop();
        true
    }

    fn include(
        &mut self,
        from: &Path,
        name: Place,
        open: &mut Vec<PathBuf>,
        tokens: &mut Vec<Token>,
    ) -> bool {
        // Stage looks in the folder of the world file, whatever file the include stands in.
        let world = self.paths[0].clone();
        let (first, second) = (self.beside(&world, name), self.beside(from, name));
        let (path, bytes) = match self.files.read(&first, self.bytes_left) {
            Err(error) if error.kind() == ErrorKind::NotFound && second != first => {
                let bytes = self.files.read(&second, self.bytes_left);
                (second, bytes)
            }
            bytes => (first, bytes),
        };
        if open.contains(&path) || open.len() >= MAX_DEPTH {
            let what = format!("`{}` includes itself", path.display());
            let what = if open.contains(&path) { what } else { "too many includes in each other".to_owned() };
            self.error(name, &what, "this leads back here", "leave one of the includes out");
            return false;
        }
        match bytes {
            Ok(bytes) => self.append(&path, bytes, open, tokens),
            Err(error) => {
                let what = format!("cannot read `{}`: {error}", path.display());
                let help = "included files are looked for beside the world file, then beside the file that includes them";
                self.error(name, &what, "", help);
                false
            }
        }
    }

    /// The path of a file that is named in another one.
    pub(super) fn beside(&self, from: &Path, name: Place) -> PathBuf {
        // Not by the disk: `a/../b` is `b` here, so that a file has one name.
        let mut path = from.parent().unwrap_or(Path::new("")).to_owned();
        for part in Path::new(self.text(name)).components() {
            match part {
                std::path::Component::CurDir => {}
                std::path::Component::ParentDir if path.file_name().is_some() => {
                    path.pop();
                }
                other => path.push(other),
            }
        }
        path
    }

    /// The file that a place is in.
    pub(super) fn path(&self, place: Place) -> &Path {
        &self.paths[place.file as usize]
    }

    /// What stands at a place.
    pub(super) fn text(&self, place: Place) -> &str {
        self.texts[place.file as usize].text.get(place.range()).unwrap_or_default()
    }

    /// The line of a place in its file, from 1 on.
    pub(super) fn line(&self, place: Place) -> usize {
        self.texts[place.file as usize].line_number(place.start as usize)
    }

    /// A place as a person would name it, as in `cave.world:12`.
    pub(super) fn name(&self, place: Place) -> String {
        format!("{}:{}", self.texts[place.file as usize].name, self.line(place))
    }

    /// The files, as they are called in messages.
    pub(super) fn file_names(&self) -> impl Iterator<Item = &str> {
        self.texts.iter().map(|text| text.name.as_str())
    }

    /// Remembers that what is called `name` changes nothing.
    pub(super) fn harmless(&mut self, place: Place, name: &str) {
        let line = self.line(place);
        self.harmless.add(place.file, line, name);
    }

    /// Adds a note per file of everything that changes nothing.
    pub(super) fn note_harmless(&mut self) {
        let help =
            "they say how Stage draws or runs a world, or are about what is not here; in ( ) are their lines";
        for (file, names) in self.harmless.take() {
            let what = format!("these change nothing here: {names}");
            self.findings.add_file(Severity::Note, &self.paths[file as usize], &what, help);
        }
    }

    pub(super) fn error(&mut self, place: Place, what: &str, label: &str, help: &str) {
        let text = &self.texts[place.file as usize];
        self.findings.add(Severity::Error, text, what, (place.range(), label), help);
    }

    pub(super) fn warning(&mut self, place: Place, what: &str, label: &str, help: &str) {
        let text = &self.texts[place.file as usize];
        self.findings.add(Severity::Warning, text, what, (place.range(), label), help);
    }

    pub(super) fn note(&mut self, place: Place, what: &str, help: &str) {
        let text = &self.texts[place.file as usize];
        self.findings.add(Severity::Note, text, what, (place.range(), ""), help);
    }
}

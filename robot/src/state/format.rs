//! A state as bytes: a header, and a body that postcard writes and LZ4 compresses.
//!
//! ```text
//! 0  the kind of file, 8 bytes
//! 8  the version of the format, 4 bytes
//! 12 the hash of the layout, 16 hexadecimal digits
//! 28 the checksum of all that follows, 8 bytes: XXH3 with the version as its seed
//! 36 the length of the body, 4 bytes, and the compressed body
//! ```
//!
//! Numbers are little-endian.

use super::facts::Facts;
use crate::build::{BUILD, other_build};
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64_with_seed;

/// The version of the format.
const VERSION: u32 = 1;
/// A hash of all types that can be in a file: see `layout.rs`.
pub const LAYOUT: &str = env!("CURIOUS_LAYOUT");
/// The part with the build.
const BUILD_PART: &str = "build";
/// The largest body, bytes: what a mapper with the largest map can take.
const MAX_BODY: usize = 2 << 30;

/// The error for bytes that are not the state of this run.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// The bytes do not begin like a state.
    #[error("this is not a state file")]
    OtherKind,
    /// The state was written by another version.
    #[error("this state file has version {found} of the format, and this program reads version {VERSION}")]
    OtherVersion {
        /// The version of the bytes.
        found: u32,
    },
    /// The types in the file have changed since it was written.
    #[error(
        "this state file has another layout: until version 0.1.0, only builds with the same layout read it; map the place again"
    )]
    OtherLayout,
    /// Bytes are missing, or were changed.
    #[error("the state file is damaged: its checksum does not fit")]
    Damaged,
    /// The state was saved by a program that has no such part.
    #[error("the state was saved by another program: it has no part `{0}`")]
    NoSection(String),
    /// The state is too large for a file.
    #[error(
        "the state has {bytes} bytes, and a state file holds {MAX_BODY} at most; a map of fewer cells is smaller"
    )]
    TooLarge {
        /// The bytes of the body.
        bytes: usize,
    },
    /// The state was saved by another build, whose results can differ.
    #[error("the state {0}")]
    OtherBuild(String),
    /// The state belongs to another run.
    #[error("the state is of another run: `{name}` is {saved} there, and {expected} here")]
    OtherFacts {
        /// What differs.
        name: String,
        /// The value of the run that saved the state.
        saved: String,
        /// The value of this run.
        expected: String,
    },
    /// A run was interrupted or refused before it learned anything.
    #[error(
        "nothing is learned in this state yet: its run ended in the first pass; run map_log again, with logs of this place"
    )]
    NothingLearned,
    /// The facts are those of this run, but the bytes are not a snapshot of this part.
    #[error("the part `{0}` of the state does not fit this program")]
    OtherContent(String),
}

/// The snapshots of the parts of a run.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct State {
    sections: Vec<Section>,
}

#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
struct Section {
    name: String,
    facts: Facts,
    snapshot: Vec<u8>,
}

impl State {
    /// How a state begins.
    pub(crate) const MAGIC: &[u8; 8] = b"\x89learned";

    /// Adds the snapshot of a part. `facts` is what it belongs to.
    #[must_use]
    pub fn with(mut self, name: &str, facts: Facts, snapshot: Vec<u8>) -> Self {
        self.sections.push(Section { name: name.to_owned(), facts, snapshot });
        self
    }

    /// Whether there is a snapshot of a part.
    pub fn has(&self, name: &str) -> bool {
        self.sections.iter().any(|section| section.name == name)
    }

    /// What the snapshot of a part belongs to.
    pub fn facts(&self, name: &str) -> Option<&Facts> {
        self.sections.iter().find(|section| section.name == name).map(|section| &section.facts)
    }

    /// The state with the build of this program.
    #[must_use]
    pub fn with_build(self) -> Self {
        self.with(BUILD_PART, Facts::default(), BUILD.into())
    }

    /// The build of the program that saved the state; empty if it did not say it.
    pub fn build(&self) -> &str {
        let part = self.sections.iter().find(|section| section.name == BUILD_PART);
        part.and_then(|section| std::str::from_utf8(&section.snapshot).ok()).unwrap_or_default()
    }

    /// Checks that this program computes the same bits as the one that saved the state.
    ///
    /// # Errors
    ///
    /// When it is another build, or an unknown one.
    pub fn check_build(&self) -> Result<(), StateError> {
        match self.build() {
            BUILD => Ok(()),
            other => Err(StateError::OtherBuild(other_build(other))),
        }
    }

    /// The snapshot of a part.
    ///
    /// # Errors
    ///
    /// When there is none, and when it belongs to other facts; the error names the first that differs.
    pub fn section(&self, name: &str, facts: &Facts) -> Result<&[u8], StateError> {
        let section = self.sections.iter().find(|section| section.name == name);
        let section = section.ok_or_else(|| StateError::NoSection(name.to_owned()))?;
        match section.facts.differences(facts).into_iter().next() {
            None => Ok(&section.snapshot),
            Some(other) => Err(other.into()),
        }
    }

    /// Adds the parts with these names of another state, as they are there.
    #[must_use]
    pub fn with_parts_of(mut self, other: &Self, names: &[&str]) -> Self {
        let is_named = |section: &&Section| names.contains(&section.name.as_str());
        self.sections.extend(other.sections.iter().filter(is_named).cloned());
        self
    }

    /// The names of its parts, what each belongs to, and the bytes of each.
    pub fn sections(&self) -> impl Iterator<Item = (&str, &Facts, &[u8])> {
        self.sections
            .iter()
            .map(|section| (section.name.as_str(), &section.facts, section.snapshot.as_slice()))
    }

    /// The state as the bytes of a file.
    ///
    /// # Errors
    ///
    /// When the state is too large.
    pub fn to_bytes(&self) -> Result<Vec<u8>, StateError> {
        // Strings and lists always can be written. An empty body would be refused.
        let body = postcard::to_stdvec(self).unwrap_or_default();
        check_length(body.len())?;
        let packed = lz4_flex::compress_prepend_size(&body);
        let checksum = xxh3_64_with_seed(&packed, VERSION.into());
        let header = [&Self::MAGIC[..], &VERSION.to_le_bytes(), LAYOUT.as_bytes(), &checksum.to_le_bytes()];
        Ok([&header.concat()[..], &packed].concat())
    }

    /// The state in the bytes of a file.
    ///
    /// # Errors
    ///
    /// When the bytes are another kind of file, are damaged, or come from another version.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, StateError> {
        let rest = bytes.strip_prefix(Self::MAGIC).ok_or(StateError::OtherKind)?;
        let (found, rest) = rest.split_first_chunk().ok_or(StateError::Damaged)?;
        let found = u32::from_le_bytes(*found);
        let (layout, rest) = rest.split_first_chunk::<16>().ok_or(StateError::Damaged)?;
        let (checksum, packed) = rest.split_first_chunk().ok_or(StateError::Damaged)?;
        // A flipped bit of the version is damage; another version has another checksum.
        if u64::from_le_bytes(*checksum) != xxh3_64_with_seed(packed, found.into()) {
            return Err(StateError::Damaged);
        }
        if found != VERSION {
            return Err(StateError::OtherVersion { found });
        }
        if layout != LAYOUT.as_bytes() {
            return Err(StateError::OtherLayout);
        }
        let length = packed.first_chunk().ok_or(StateError::Damaged)?;
        check_length(u32::from_le_bytes(*length) as usize)?;
        let body = lz4_flex::decompress_size_prepended(packed).map_err(|_| StateError::Damaged)?;
        postcard::from_bytes(&body).map_err(|_| StateError::Damaged)
    }
}

fn check_length(bytes: usize) -> Result<(), StateError> {
    if bytes > MAX_BODY { Err(StateError::TooLarge { bytes }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_that_is_too_large_is_refused() {
        assert_eq!(check_length(MAX_BODY), Ok(()));
        let error = check_length(MAX_BODY + 1).unwrap_err().to_string();
        let expected = "the state has 2147483649 bytes, and a state file holds 2147483648 at most; a map of fewer cells is smaller";
        assert_eq!(error, expected);
    }
}

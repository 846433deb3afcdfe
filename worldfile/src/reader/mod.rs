//! Reads a world file as far as it makes sense, so that one thing being wrong does not hide another.
//!
//! The types that describe a file derive `Deserialize`. A key may be left out if it is an `Option`, a list of
//! [`Tables`], or a table all of whose keys may be left out. Where a key is unknown, missing or of the wrong
//! type, that is noted, a stand-in takes its place, and reading goes on: once over the file, however much is
//! wrong with it. No stand-in is ever seen outside, as the [`Sound`] part that it belongs to is withheld.

mod fault;
mod stand_in;
#[cfg(test)]
mod tests;
mod value;

use crate::error::{Source, WorldError, Wrong};
use crate::kind::Kind;
use fault::Faults;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_spanned::Spanned;
use toml::de::{DeTable, DeValue};
use value::Value;

/// A file that was read.
pub(crate) struct Reading<T> {
    /// What it says.
    pub(crate) file: T,
    /// What is wrong with its keys and their types.
    pub(crate) wrong: Wrong,
    /// Whether all keys are right that stand in no table.
    pub(crate) is_root_sound: bool,
}

/// A part of a file, with its place; only to be had if every key in it is right.
#[derive(Deserialize)]
pub(crate) struct Sound<T>(Spanned<T>, bool);

impl<T> Sound<T> {
    pub(crate) fn get(&self) -> Option<&Spanned<T>> {
        self.1.then_some(&self.0)
    }
}

/// All tables of a kind, as in `[[wall]]`; there may be none.
#[derive(Deserialize)]
#[serde(transparent)]
pub(crate) struct Tables<T>(Option<Vec<Sound<T>>>);

impl<T> Tables<T> {
    /// Those whose keys are right.
    pub(crate) fn sound(&self) -> Vec<&Spanned<T>> {
        self.0.iter().flatten().filter_map(Sound::get).collect()
    }

    /// Whether that is all of them.
    pub(crate) fn are_sound(&self) -> bool {
        self.0.iter().flatten().all(|table| table.get().is_some())
    }
}

/// A table, or a list of tables.
#[derive(Deserialize)]
pub(crate) struct OneOrMore<T>(pub(crate) Vec<T>);

/// Reads a file that is to describe a world of this kind.
///
/// # Errors
///
/// When the text is no TOML, or describes a world of the other kind.
pub(crate) fn read<T: DeserializeOwned>(source: &Source<'_>, kind: Kind) -> Result<Reading<T>, WorldError> {
    let root = DeTable::parse(source.text).map_err(|error| source.syntax_error(&error))?;
    kind.check(source, root.get_ref())?;
    let root = Spanned::new(root.span(), DeValue::Table(root.into_inner()));
    let faults = Faults::default();
    let file = T::deserialize(Value::root(&root, &faults));
    let file = file.map_err(|error| {
        source.error(
            &error.to_string(),
            (0..0, ""),
            &[],
            "the keys of world files are in `worldfile/keys.md`",
        )
    })?;
    Ok(Reading { file, is_root_sound: !faults.is_any_at_root(), wrong: faults.told(source) })
}

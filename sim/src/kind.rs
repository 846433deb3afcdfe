//! Which kind of world a file describes.

use crate::error::{Source, WorldError};
use toml::de::{DeTable, DeValue};

/// The two kinds of worlds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Grid,
    Physics,
}

impl Kind {
    /// What is wrong with a file that was to describe a world of this kind: that it describes one
    /// of the other, or else what the TOML reader says.
    pub(crate) fn explain(self, source: &Source<'_>, error: toml::de::Error) -> WorldError {
        let other = DeTable::parse(source.text).ok().and_then(|table| {
            let (key, value) = table.get_ref().get_key_value("map")?;
            // A drawing, or a table of sizes.
            match (self, value.get_ref()) {
                (Self::Physics, DeValue::String(_)) | (Self::Grid, DeValue::Table(_)) => Some(key.span()),
                _ => None,
            }
        });
        match (self, other) {
            (_, None) => source.toml_error(error),
            (Self::Grid, Some(place)) => source.error(
                "this is a physics world, not a grid world",
                (place, "sizes, not a drawing"),
                &[],
                "a grid world draws its `map` as text: `#` wall, `.` free, one row of text per row of cells",
            ),
            (Self::Physics, Some(place)) => source.error(
                "this is a grid world, not a physics world",
                (place, "a drawing, not sizes"),
                &[],
                "a physics world has a table `[map]` with `size_m` and `cell_m`",
            ),
        }
    }
}

//! Which kind of file a text is.

use crate::error::{Source, WorldError};
use toml::de::{DeTable, DeValue};

/// The kinds of files: two kinds of worlds, and tours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Grid,
    Physics,
    Tour,
}

impl Kind {
    /// Refuses a file that describes a world of the other kind.
    pub(crate) fn check(self, source: &Source<'_>, file: &DeTable<'_>) -> Result<(), WorldError> {
        let Some((key, value)) = file.get_key_value("map") else { return Ok(()) };
        // A drawing, or a table of sizes.
        let (what, label, help) = match (self, value.get_ref()) {
            (Self::Grid, DeValue::Table(_)) => (
                "this is a physics world, not a grid world",
                "sizes, not a drawing",
                "a grid world draws its `map` as text: `#` wall, `.` free, one row of text per row of cells",
            ),
            (Self::Physics, DeValue::String(_)) => (
                "this is a grid world, not a physics world",
                "a drawing, not sizes",
                "a physics world has a table `[map]` with `size_m` and `cell_m`",
            ),
            _ => return Ok(()),
        };
        Err(source.error(what, (key.span(), label), &[], help))
    }
}

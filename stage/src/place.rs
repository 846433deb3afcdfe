//! Places in the texts of a world.

use std::ops::Range;

/// A place in one of the texts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) file: u32,
    pub(super) start: u32,
    pub(super) end: u32,
}

impl Place {
    pub(super) fn range(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

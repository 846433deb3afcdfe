//! What takes the place of the recording in a build without the feature `recording`: there is none.

use draw::view::View;

/// A recording that cannot be made.
pub enum Recorder {}

/// The error of a recording, which cannot happen.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {}

impl Recorder {
    pub(crate) fn log(&mut self, _: &View, _: bool) -> Result<(), RecordingError> {
        match *self {}
    }

    pub(crate) fn is_live(&self) -> bool {
        match *self {}
    }

    pub(crate) fn live_problem(&self) -> Option<String> {
        match *self {}
    }
}

//! The display of a run: the Rerun recording, beside the pictures of `draw`. This is the only crate that knows Rerun, and only with the feature `recording`; it must not
//! know command lines, world files, or how a run is made.
//!
//! It reads the state of a run and changes nothing: no result depends on the display.

#[cfg(all(test, feature = "recording"))]
#[path = "../../draw/src/tests/fake_run.rs"]
mod fake_run;
#[cfg(not(feature = "recording"))]
mod no_recording;
#[cfg(feature = "recording")]
pub mod recording;
pub mod show;

/// There is no recording in a build without the feature `recording`.
#[cfg(not(feature = "recording"))]
pub mod recording {
    pub use crate::no_recording::{Recorder, RecordingError};
}

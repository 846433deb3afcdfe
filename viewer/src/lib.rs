//! The display of a run: the scene of a world, the layers of a map, pictures, a moving picture, and the Rerun
//! recording. This is the only crate that knows Rerun, and only with the feature `recording`; it must not
//! know command lines, world files, or how a run is made.
//!
//! It reads the state of a run and changes nothing: no result depends on the display.

pub mod layers;
mod legend;
#[cfg(not(feature = "recording"))]
mod no_recording;
mod outline;
pub mod pictures;
#[cfg(feature = "recording")]
pub mod recording;
pub mod scene;
pub mod show;
#[cfg(all(test, feature = "recording"))]
mod tests;
pub mod view;

/// There is no recording in a build without the feature `recording`.
#[cfg(not(feature = "recording"))]
pub mod recording {
    pub use crate::no_recording::{Recorder, RecordingError};
}

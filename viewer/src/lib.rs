//! The display of a run: the Rerun recording, beside the pictures of `draw`. This is the only crate that knows Rerun, and only with the feature `recording`; it must not
//! know command lines, world files, or how a run is made.
//!
//! It reads the state of a run and changes nothing: no result depends on the display.

#[cfg(all(test, feature = "recording"))]
#[path = "../../draw/src/tests/fake_run.rs"]
mod fake_run;
#[cfg(feature = "recording")]
pub mod recording;
#[cfg(not(feature = "recording"))]
#[path = "no_recording.rs"]
pub mod recording;
pub mod show;

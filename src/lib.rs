//! The programs, and the code that they share: arguments and exit codes, worlds and warnings about them,
//! progress, lines for the user, the keyboard pilot, and trials. It must not know how a robot maps, decides
//! or is measured: the other crates do.

pub mod bag;
pub mod busy;
pub mod flags;
#[cfg(feature = "simulation")]
pub mod keyboard;
pub mod program;
pub mod progress;
#[cfg(feature = "simulation")]
pub mod reachability;
pub mod terminal;
#[cfg(feature = "recording")]
pub mod trials;
pub mod week;
pub mod words;
#[cfg(feature = "simulation")]
pub mod worlds;

//! Code that the programs share: arguments and exit codes, worlds and warnings about them, progress, lines for the
//! user, the keyboard pilot, trials, and experiments in shards.

pub mod bag;
pub mod flags;
pub mod keyboard;
pub mod program;
pub mod progress;
#[cfg(feature = "simulation")]
pub mod reachability;
#[cfg(feature = "recording")]
pub mod shards;
pub mod terminal;
#[cfg(feature = "recording")]
pub mod trials;
pub mod words;
#[cfg(feature = "simulation")]
pub mod worlds;

//! Code that the programs share: arguments and exit codes, worlds, progress, lines for the user, the
//! keyboard pilot, trials.

pub mod keyboard;
pub mod program;
pub mod progress;
pub mod terminal;
pub mod trials;
pub mod worlds;

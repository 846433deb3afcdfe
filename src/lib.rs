//! Code that the programs share: arguments and exit codes, worlds and warnings about them, progress, lines for the
//! user, the keyboard pilot, trials.

pub mod keyboard;
pub mod program;
pub mod progress;
pub mod reachability;
pub mod terminal;
pub mod trials;
pub mod worlds;

//! Code that the programs share: arguments and exit codes, worlds, progress, and the keyboard pilot.

pub mod keyboard;
pub mod program;
pub mod progress;
pub mod worlds;

//! What the programs share: the shipped worlds, what is shown of a run, and the keyboard pilot.

pub mod keyboard;
pub mod progress;
pub mod worlds;

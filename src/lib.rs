//! What the programs share: the shipped worlds, what is shown of a run, and the keyboard pilot.

#[cfg(test)]
mod fake;
pub mod keyboard;
pub mod layer;
pub mod pictures;
pub mod recording;
pub mod show;
pub mod view;
pub mod worlds;

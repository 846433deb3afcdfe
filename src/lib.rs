//! The programs of simulated worlds, and the code that they share: worlds and warnings about them, how they are displayed,
//! the keyboard pilot, and trials. It must not know how a robot maps, decides
//! or is measured: the other crates do.

pub mod keyboard;
pub mod reachability;
pub mod scenes;
#[cfg(feature = "recording")]
pub mod trials;
pub mod worlds;

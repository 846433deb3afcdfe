//! The programs for one simulated world, and the code that the programs of simulations share: worlds and warnings about
//! them. It must not know how a robot maps, decides or is measured: the other crates do.

pub mod reachability;
pub mod worlds;

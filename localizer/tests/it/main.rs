//! The localizer as a robot uses it: scans of a small house, an odometry that drifts, and a map that learns changes.

#[path = "../../../mapper/tests/house/mod.rs"]
mod house;

mod coherent_motion;
mod faults;
mod glitches;
mod loops;
mod missing;
mod robot;
mod tracking;
mod unknown_start;

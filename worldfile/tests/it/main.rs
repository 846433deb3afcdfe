//! Worlds written as text, run by the crate `sim`.
mod grid;
mod physics;
mod ros_map;

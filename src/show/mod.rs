//! Runs of both worlds, as the recording and the pictures show them.

mod grid;
mod physics;

pub use grid::{RECORDED_STEPS, Recorded, record, rectangle, scene};
pub use physics::PhysicsShow;

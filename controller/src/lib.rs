//! Takes a goal, drives the robot there and explores around it (paper, section 2).
//!
//! ```text
//! map ─▶ Inflation ─▶ Costmap ─▶ Wavefront ─▶ Path ─▶ Drive ─▶ command
//! ```
//!
//! [`Controller`] is all that a loop needs: give it a goal, and at every tick a [`Situation`].
//! It knows neither how the map is learned nor which world it is in: a [`Drive`] tells what the
//! robot's body is like and turns paths into that world's commands. [`DiffDrive`] is the one for
//! the physics world, [`CellDrive`] the one for the grid world.

mod cell_drive;
mod controller;
mod costmap;
mod diff_drive;
#[cfg(test)]
mod drawing;
mod drive;
mod exploration;
mod inflation;
mod journey;
mod path;
mod planner;
mod restless;
mod settings;
mod situation;
mod wavefront;

pub use cell_drive::CellDrive;
pub use controller::{Controller, Outcome, Status};
pub use costmap::{CLOSED, Costmap, DIAGONAL, MAX_PRICE, Moves, OPEN, STRAIGHT};
pub use diff_drive::{DiffDrive, DiffDriveSettings};
pub use drive::{Body, Drive, Scene};
pub use inflation::{Inflation, InflationSettings};
pub use path::Path;
pub use planner::{Planner, Reach};
pub use restless::Restless;
pub use settings::{ExplorationSettings, PatienceSettings, Settings};
pub use situation::Situation;
pub use wavefront::Wavefront;

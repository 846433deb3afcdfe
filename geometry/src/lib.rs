//! The values that two crates exchange: cells and grids, scans and readings, commands, and the
//! two verbs of a world. No clock, no input or output, no chance.
//!
//! Units are SI; a scalar's name carries its unit. Frames follow REP-103 (x forward, y left,
//! counter-clockwise radians). Grids are row-major with row 0 at the lowest y.

mod angle;
mod cell;
mod command;
mod grid;
mod reading;
mod scan;
mod state;
mod world;

pub use angle::{heading_rad, pose, rotation, wrap_rad};
pub use cell::Cell;
pub use command::{Step, Twist};
pub use grid::{Grid, GridFrame};
pub use reading::{CellReading, LaserReading, Reading};
pub use scan::{Scan, ScanError};
pub use state::{CellState, Event, Transition};
pub use world::World;

//! The values and traits that the crates exchange: cells and grids, scans and readings, commands, the traits
//! [`World`] and [`GroundTruth`], parts chosen by name, the changing values of a part as bytes, checks of
//! settings, text that is safe to print, and seeded random streams. It must not know any other crate of the
//! workspace, a clock, or a file.
//!
//! Units are SI; the name of a scalar carries its unit. Frames follow REP-103 (x forward, y left,
//! counter-clockwise radians). Grids are row-major with row 0 at the lowest y.

mod angle;
mod by_name;
mod cell;
mod command;
mod grid;
mod ground_truth;
mod obstacles;
mod pose_mode;
mod printable;
mod random;
mod reading;
mod scan;
pub mod serde_pose;
pub mod serde_time;
mod settings;
mod sparse_cells;
mod state;
mod values;
mod world;

pub use angle::{
    APPROXIMATE_ATAN2_ERROR_RAD, FARTHEST_M, Spread, approximate_atan2, heading_rad, is_valid_pose, median,
    pose, rotation, wrap_rad,
};
pub use by_name::UnknownName;
pub use cell::Cell;
pub use command::{Step, Twist};
pub use grid::{Grid, GridFrame};
pub use ground_truth::{GroundTruth, TrueChange, TrueState};
pub use obstacles::Obstacles;
pub use pose_mode::PoseMode;
pub use printable::{is_printable, printable, printable_lines};
pub use random::{Purpose, RandomStream};
pub use reading::{CellReading, LaserReading, Observation, Reading, VelocitySample};
pub use scan::{Scan, ScanError};
pub use settings::{SettingsCheck, SettingsError};
pub use sparse_cells::{Place, SMALL_GRID, SparseCells};
pub use state::{CellState, Event, Transition};
pub use values::{
    CellList, Value, ValueError, Values, cell_runs, converted, from_bytes, read_value, read_values, restore,
    runs, snapshot, to_bytes, value, write_value, write_values,
};
pub use world::World;

//! The quality of a robot: metrics over the ground truth of a simulated world, trials, statistics and reports.
//!
//! This crate must not know the command line, recordings or screens.

pub mod cell_statistics;
pub mod drawing;
pub mod file_name;
pub mod map_hash;
pub mod metrics;
pub mod observer;
pub mod oracle;
pub mod output;
pub mod palette;
pub mod percent;
pub mod physics_trial;
pub mod raster;
pub mod report;
pub mod shards;
pub mod summary;
pub mod thinned;
pub mod trial_state;
pub mod trials;

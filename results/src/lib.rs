//! What a run leaves behind: trajectories, what the mapper has learned as a table, as an array, and as maps for ROS. It must not
//! know where readings come from: the results of a simulated robot and of a log have the
//! same files.

pub mod cell_statistics;
pub mod file_name;
pub mod numbers;
pub mod raster;
pub mod ros_map;
pub mod things;
pub mod thinned;
mod trajectory;

pub use trajectory::TrajectoryFile;
